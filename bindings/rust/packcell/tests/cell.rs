//! A planned step is scheduled, simulated and written down.

use packcell::*;

#[test]
fn a_step_goes_through_the_cell() {
    assert!(Cell::presets().contains(&"ur5e".to_string()));
    let cell = match Cell::new("ur5e") {
        Err(e) if e.status() == Status::Unsupported => return, // a library without the cell
        cell => cell.unwrap(),
    };
    assert_eq!(cell.name().unwrap(), "ur5e");
    let info = cell.info().unwrap();
    let scenario: Scenario = "D-R5A3O1".parse().unwrap();
    cell.check(&scenario).unwrap();
    let again = Cell::load(&cell.save().unwrap()).unwrap();
    assert_eq!(again.info().unwrap(), info);

    let mut bin = Bin::new(info.bin_w, info.bin_h).unwrap();
    let mut queue = Queue::new(&scenario).unwrap();
    for id in 0..4 {
        queue.push(&item(id, 2, 1)).unwrap();
    }
    let mut planner = Planner::new(&PlannerOptions::default(), None).unwrap();
    let mut schedule = Schedule::new(&cell, &scenario, Mode::Coordinated).unwrap();
    drop(cell); // the schedule keeps what it needs
    let mut actions = planner
        .plan(&bin, &queue, &Budget::nodes(1_000))
        .unwrap()
        .actions;
    again.allocate(&queue, &mut actions).unwrap();
    schedule.add_step(&bin, &queue, &actions).unwrap();
    apply(&mut bin, &mut queue, &actions).unwrap();

    let times = schedule.info().unwrap();
    assert!(times.steps == 1 && times.makespan > 0.0);
    let sample = schedule.sample(0, times.makespan / 2.0).unwrap();
    let joints = again.inverse(0, &sample.tool);
    if let Ok(joints) = joints {
        let pose = again.forward(0, &joints).unwrap();
        assert!((pose[0] - sample.tool[0]).abs() < 1e-6);
    }

    let simulation = schedule.simulate(&SimulationOptions::default()).unwrap();
    assert_eq!(simulation.info().unwrap().jams, 0);
    assert_eq!(
        simulation.places().unwrap().len(),
        bin.items().unwrap().len()
    );
    let same = schedule.simulate(&SimulationOptions::default()).unwrap();
    assert_eq!(same.info().unwrap().hash, simulation.info().unwrap().hash);

    let path = std::env::temp_dir().join(format!("packcell-{}.svg", std::process::id()));
    schedule
        .write_trace(Some(&simulation), Trace::Gantt, &path)
        .unwrap();
    let svg = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(svg.contains("<svg"));

    let late = schedule.sample(0, times.makespan + 1.0).unwrap_err();
    assert_eq!(late.status(), Status::Argument);
    assert_eq!(
        schedule.put_aside(99, 0.0).unwrap_err().status(),
        Status::State
    );
}

#[test]
fn a_layout_is_never_worse() {
    let cell = match Cell::new("scara") {
        Err(e) if e.status() == Status::Unsupported => return,
        cell => cell.unwrap(),
    };
    let mut options = LayoutOptions::default();
    options.evaluations = 20;
    let scenario = "D-R5A3O1".parse().unwrap();
    let (moved, info) = cell.optimize_layout(&scenario, &options).unwrap();
    assert!(info.after <= info.before);
    moved.check(&scenario).unwrap();
}
