// Prints the layout of every struct as koffi has it; the argument is the raw layer.
'use strict';

const { structs } = require(process.argv[2]);

for (const [name, type] of Object.entries(structs)) {
  console.log(`${name} ${type.size}`);
  for (const member of Object.values(type.members)) {
    console.log(`${name}.${member.name} ${member.offset}`);
  }
}
