//! Bins, queues, policies, planners and the exact packer do what the header says.

use packcell::*;

fn bin() -> Bin {
    Bin::new(10, 10).unwrap()
}

fn queue(name: &str, sizes: &[(i32, i32)]) -> Queue {
    let mut queue = Queue::new(&name.parse().unwrap()).unwrap();
    for (id, &(w, h)) in (0..).zip(sizes) {
        queue.push(&item(id, w, h)).unwrap();
    }
    queue
}

#[test]
fn the_library_is_the_one_of_the_header() {
    assert_eq!(version(), (0, 1, 0));
}

#[test]
fn a_bin_holds_what_is_packed() {
    let mut bin = bin();
    bin.block(9, 9, 1, 1).unwrap();
    bin.pack(&item(7, 2, 3), 0, 0, 1).unwrap();
    let info = bin.info().unwrap();
    assert_eq!((info.w, info.h, info.items), (10, 10, 1));
    assert_eq!((info.occupied_cells, info.fixed_cells), (7, 1));
    let cells = bin.cells().unwrap();
    assert_eq!((cells[0], cells[3], cells[99]), (7, CELL_FREE, CELL_FIXED));
    assert_eq!(bin.feasible(10, 1).unwrap().len(), 101);
    assert_eq!(bin.contact(3, 0, 1, 1).unwrap(), 2);

    let copy = bin.try_clone().unwrap();
    let placement = bin.unpack(7).unwrap();
    assert_eq!((placement.item.id, placement.rot), (7, 1));
    assert!(bin.items().unwrap().is_empty());
    assert_eq!(copy.items().unwrap(), [placement]);
    bin.clear().unwrap();
    assert_eq!(bin.info().unwrap().occupied_cells, 1);
}

#[test]
fn a_scenario_has_a_name() {
    let scenario: Scenario = "D-R5A3O1".parse().unwrap();
    assert_eq!(
        (scenario.robots, scenario.recognized, scenario.overlap),
        (2, 5, 1)
    );
    assert_eq!(scenario.to_string(), "D-R5A3O1");
    assert_eq!(Scenario::default().to_string(), "S-R1A1");
}

#[test]
fn a_queue_knows_what_is_in_reach() {
    let mut queue = queue("D-R5A3O1", &[(1, 1); 8]);
    queue.put_in_buffer(&item(20, 2, 2), 1).unwrap();
    let info = queue.info().unwrap();
    assert_eq!((info.belt, info.buffered), (8, 1));
    assert_eq!(
        queue
            .belt()
            .unwrap()
            .iter()
            .filter(|q| q.recognized == 1)
            .count(),
        5
    );
    assert_eq!(queue.buffer().unwrap()[0].item.id, 20);
    queue.remove(0).unwrap();
    queue.remove_items(&[1, 2]).unwrap();
    queue.set_alpha_left(0).unwrap();
    assert_eq!(queue.try_clone().unwrap().info().unwrap().belt, 5);
    assert_eq!(queue.scenario().unwrap().to_string(), "D-R5A3O1");
}

#[test]
fn a_snapshot_gives_the_same_again() {
    let mut bin = bin();
    bin.pack(&item(7, 2, 3), 0, 0, 0).unwrap();
    let queue = queue("S-R3A2", &[(1, 2), (2, 2)]);
    let bytes = save_snapshot(&bin, &queue).unwrap();
    let (other_bin, other_queue) = load_snapshot(&bytes).unwrap();
    assert_eq!(other_bin.info().unwrap(), bin.info().unwrap());
    assert_eq!(other_queue.belt().unwrap(), queue.belt().unwrap());
}

#[test]
fn policies_choose_and_the_learned_ones_evaluate() {
    assert!(Policy::builtins().contains(&"contact".to_string()));
    let contact = Policy::new("contact").unwrap();
    assert_eq!(
        (contact.name(), contact.learner().unwrap()),
        ("contact".into(), "".into())
    );
    let (one, two) = (bin(), bin());
    let chosen = contact.select(&one, 2, 3).unwrap();
    assert_eq!(
        contact.select_batch(&[(&one, 2, 3), (&two, 2, 3)]).unwrap(),
        [chosen; 2]
    );

    let learned = Policy::new("default").unwrap();
    let again = Policy::load(&learned.save().unwrap()).unwrap();
    assert_eq!(
        again.info().unwrap().parameters,
        learned.info().unwrap().parameters
    );
    if let Ok(said) = learned.evaluate(&one, 2, 3) {
        assert_eq!((said.logits.len(), said.probabilities.len()), (101, 101));
        let batch = learned.evaluate_batch(&[(&one, 2, 3)]).unwrap();
        assert_eq!((batch.positions.len(), batch.probabilities.len()), (1, 101));
        assert_eq!(batch.positions[0], learned.select(&one, 2, 3).unwrap());
    }
}

#[test]
fn slices_give_the_plan_that_one_call_gives() {
    let mut options = PlannerOptions::default();
    options.repack = plan::REPACK_FULL;
    let mut planner = Planner::new(&options, Some(&Policy::new("contact").unwrap())).unwrap();
    let (bin, queue) = (
        bin(),
        queue("D-R5A3O1", &[(2, 1), (4, 3), (2, 2), (4, 4), (2, 4)]),
    );
    let budget = Budget::nodes(5_000);
    let whole = planner.plan(&bin, &queue, &budget).unwrap();
    planner.begin(&bin, &queue, &budget).unwrap();
    while !planner.step(100).unwrap() {}
    assert_eq!(planner.result().unwrap().actions, whole.actions);
    assert_eq!(plan_hash(&whole.actions).unwrap(), whole.info.hash);
}

#[test]
fn another_thread_cancels_a_plan() {
    let mut planner = Planner::new(&PlannerOptions::default(), None).unwrap();
    let canceller = planner.canceller();
    let bin = Bin::new(60, 60).unwrap();
    let queue = queue(
        "D-R40A10O2",
        &[(7, 5), (3, 9), (8, 2), (5, 4), (6, 6), (2, 11)].repeat(7),
    );
    let worker =
        std::thread::spawn(move || planner.plan(&bin, &queue, &Budget::milliseconds(20_000.0)));
    while !worker.is_finished() {
        canceller.cancel().unwrap();
        std::thread::yield_now();
    }
    let plan = worker.join().unwrap().unwrap();
    assert_eq!(plan.info.cancelled, 1);
    assert!(!plan.actions.is_empty());
}

#[test]
fn threads_share_a_policy() {
    let policy = Policy::new("contact").unwrap();
    std::thread::scope(|s| {
        let choose = || policy.select(&bin(), 2, 3).unwrap();
        let other = s.spawn(choose);
        assert_eq!(choose(), other.join().unwrap());
    });
}

#[test]
fn handles_go_to_other_threads_and_immutable_ones_are_shared() {
    fn goes<T: Send>() {}
    fn is_shared<T: Send + Sync>() {}
    goes::<(Bin, Queue, Planner, Schedule, Simulation, Generator)>();
    is_shared::<(Policy, Cell, Canceller, Error)>();
}

#[test]
fn the_exact_packer_decides() {
    let bin = Bin::new(4, 4).unwrap();
    let items = [item(0, 2, 4), item(1, 4, 2)];
    let budget = Budget::default();
    match exact_pack(&bin, &items, true, &budget).unwrap() {
        Packing::Found(placements) => assert_eq!(placements.len(), 2),
        other => panic!("{other:?}"),
    }
    assert_eq!(
        exact_pack(&bin, &items, false, &budget).unwrap(),
        Packing::Impossible
    );
    let bound = bound_in_order(&bin, &items, false, &budget).unwrap();
    assert_eq!(
        bound,
        Bound {
            count: 1,
            exact: true
        }
    );
}

#[test]
fn generators_give_equal_items_for_equal_options() {
    let mut options = GeneratorOptions::default();
    let random = Generator::new(&options).unwrap().items(20).unwrap();
    assert_eq!(random.len(), 20);
    assert_eq!(Generator::new(&options).unwrap().items(20).unwrap(), random);

    options.kind = GENERATE_FULL;
    options.preset("text").unwrap();
    let set = Generator::new(&options).unwrap().items(100).unwrap();
    assert_eq!(set.iter().map(|i| i.w * i.h).sum::<i32>(), 100);
}

#[test]
fn a_grid_goes_from_millimetres_to_cells_and_back() {
    let mut grid = Grid::default(); // the paper's: 320 x 260, margin 10, cell 30, clearance 0
    assert_eq!(grid.bin().unwrap(), Size { w: 10, h: 8 });
    assert_eq!(grid.item(31.0, 90.0).unwrap(), Size { w: 2, h: 3 });
    assert_eq!(grid.centre(0, 0, 1, 1).unwrap(), (25.0, 25.0));
    grid.clearance = 5.0;
    assert_eq!(grid.item(30.0, 25.0).unwrap(), Size { w: 2, h: 1 });
    grid.cell = f64::NAN;
    assert_eq!(grid.bin().unwrap_err().status(), Status::Argument);
}

#[test]
fn a_policy_is_measured_on_a_held_out_stream() {
    let policy = Policy::new("contact").unwrap();
    assert_eq!(policy.info().unwrap().architecture, architecture::HEURISTIC);
    let mut options = TrainerOptions::default();
    options.rotation = rotation::ON;
    let first = policy.measure(&options, 3, 200).unwrap();
    assert!(
        first.mean > 0.8 && first.mean < 0.95 && first.half_width < 0.05,
        "{first:?}"
    );
    assert_eq!(policy.measure(&options, 3, 200).unwrap(), first);
    let refused = policy.measure(&options, 3, 0).unwrap_err();
    assert_eq!(refused.status(), Status::Argument);
}

#[test]
fn a_status_has_the_name_and_the_number_of_the_header() {
    assert_eq!(Status::Argument.to_string(), "PKC_E_ARGUMENT");
    assert_eq!(Status::Busy.code(), sys::PKC_E_BUSY);
    assert_eq!(Status::Other(7).to_string(), "unknown status");
    let error = Bin::new(0, 1).unwrap_err();
    assert_eq!(Error::from_status(error.status().code()), error);
}

#[test]
fn a_raw_handle_can_be_taken_over() {
    let mut raw = std::ptr::null_mut();
    // SAFETY: `raw` is a place for the handle.
    assert_eq!(unsafe { sys::pkc_bin_create(3, 2, &mut raw) }, sys::PKC_OK);
    // SAFETY: nobody else has it.
    let bin = unsafe { Bin::from_raw(std::ptr::NonNull::new(raw).unwrap()) };
    assert_eq!(bin.info().unwrap().h, 2);
}

#[test]
fn things_may_be_dropped_in_any_order_or_never() {
    let policy = Policy::new("contact").unwrap();
    let mut planner = Planner::new(&PlannerOptions::default(), Some(&policy)).unwrap();
    drop(policy);
    let (bin, queue) = (bin(), queue("S-R1A1", &[(2, 2)]));
    planner.plan(&bin, &queue, &Budget::nodes(100)).unwrap();
    let canceller = planner.canceller();
    drop(planner);
    canceller.cancel().unwrap();
    std::mem::forget(canceller);
    std::mem::forget(bin);
}
