//! Plans 14 items into a bin of 10 x 10 cells and prints the hash of the plan, which is the same in
//! every language and on every machine.

use packcell::{item, plan, Bin, Budget, Planner, PlannerOptions, Policy, Queue, Result};

const SIZES: [(i32, i32); 14] = [
    (2, 1),
    (4, 3),
    (2, 2),
    (4, 4),
    (2, 4),
    (3, 4),
    (3, 2),
    (3, 1),
    (3, 5),
    (2, 2),
    (2, 2),
    (2, 3),
    (5, 5),
    (2, 4),
];

fn main() -> Result<()> {
    let mut bin = Bin::new(10, 10)?;
    let mut queue = Queue::new(&"D-R5A3O1".parse()?)?;
    for (id, (w, h)) in (0..).zip(SIZES) {
        queue.push(&item(id, w, h))?;
    }

    let mut options = PlannerOptions::default();
    options.repack = plan::REPACK_FULL;
    let mut planner = Planner::new(&options, Some(&Policy::new("contact")?))?;

    let mut actions = Vec::new();
    loop {
        let step = planner.plan(&bin, &queue, &Budget::nodes(20_000))?;
        packcell::apply(&mut bin, &mut queue, &step.actions)?;
        actions.extend(step.actions);
        if step.info.terminate == 1 {
            break;
        }
    }
    println!("{:016x}", packcell::plan_hash(&actions)?);
    Ok(())
}
