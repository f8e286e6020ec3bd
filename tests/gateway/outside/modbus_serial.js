// A client of the gateway over npm's modbus-serial: reads the identity registers, sends one item, and
// prints what it saw as a line of JSON. Usage: node modbus_serial.js PORT ABCD|CDAB ITEM, with
// NODE_PATH where the package is.
"use strict";
const ModbusRTU = require("modbus-serial");

// The bytes of two registers, high word first.
function bytesOf(registers, order) {
    const [first, second] = order === "ABCD" ? registers : [registers[1], registers[0]];
    const bytes = Buffer.alloc(4);
    bytes.writeUInt16BE(first, 0);
    bytes.writeUInt16BE(second, 2);
    return bytes;
}

async function refused(request, code) {
    try {
        await request;
    } catch (error) {
        if (error.modbusCode === code) return;
        throw error;
    }
    throw new Error("not refused by exception " + code);
}

async function main() {
    const [port, order, item] = process.argv.slice(2);
    const client = new ModbusRTU();
    await client.connectTCP("127.0.0.1", { port: Number(port) });
    client.setID(1);
    client.setTimeout(30000);
    const words = (await client.readHoldingRegisters(1000, 16)).data;
    const mirror = (await client.readInputRegisters(1000, 16)).data;
    if (words.join() !== mirror.join()) throw new Error("function code 4 reads otherwise");
    const status = (await client.readHoldingRegisters(200, 3)).data;
    await refused(client.readCoils(0, 1), 1);
    await refused(client.readHoldingRegisters(150, 1), 2);
    await refused(client.writeRegister(200, 1), 2);
    await client.writeRegister(96, 8);

    const number = ((await client.readHoldingRegisters(207, 1)).data[0] % 65535) + 1;
    const id = [Math.floor(item / 65536), item % 65536];
    if (order === "CDAB") id.reverse();
    const block = [number, 1, 0, ...id, 2, 3, ...new Array(40).fill(0), number];
    await client.writeRegisters(0, block);
    const ack = (await client.readHoldingRegisters(207, 2)).data;
    if (ack[0] !== number || ack[1] !== number) throw new Error("ack_seq, done_seq: " + ack);
    console.log(JSON.stringify({
        version: words.slice(0, 3),
        whole: bytesOf(words.slice(4, 6), order).readInt32BE(),
        number: Math.round(1000 * bytesOf(words.slice(6, 8), order).readFloatBE()) / 1000,
        status: status,
    }));
    client.close(() => process.exit(0));
}

main().catch((error) => {
    console.error("modbus_serial.js: " + error.message);
    process.exit(1);
});
