//! Bad input is an error with the library's message, never a crash.

use packcell::*;

fn refused<T: std::fmt::Debug>(result: Result<T>, status: Status, words: &str) {
    let error = result.expect_err(words);
    assert_eq!(error.status(), status, "{error}");
    assert!(
        error.to_string().contains(words),
        "{error:?} does not say {words:?}"
    );
}

#[test]
fn values_out_of_range_are_refused() {
    refused(Bin::new(0, 10), Status::Argument, "must be 1..128");
    refused("X-R1".parse::<Scenario>(), Status::Argument, "X-R1");
    refused(
        "S-R1\0A1".parse::<Scenario>(),
        Status::Argument,
        "a zero byte at 4",
    );
    refused(
        Policy::new("no such policy"),
        Status::Argument,
        "no such policy",
    );
    refused(
        Policy::load_file("/no/such/file"),
        Status::Io,
        "/no/such/file",
    );

    let mut bin = Bin::new(4, 4).unwrap();
    refused(bin.pack(&item(-1, 1, 1), 0, 0, 0), Status::Argument, "-1");
    bin.pack(&item(1, 2, 2), 0, 0, 0).unwrap();
    refused(bin.pack(&item(2, 2, 2), 1, 1, 0), Status::State, "");
    refused(bin.unpack(9), Status::State, "9");
    refused(bin.contact(0, 0, 1, 1), Status::State, "");

    let mut options = PlannerOptions::default();
    options.method = 77;
    refused(Planner::new(&options, None), Status::Argument, "77");
    let mut generator = GeneratorOptions::default();
    let mut stream = Generator::new(&generator).unwrap();
    refused(
        stream.items(usize::MAX),
        Status::Argument,
        "must be 0..16777216",
    );
    refused(generator.preset("nothing"), Status::Argument, "nothing");
}

#[test]
fn a_wrong_struct_size_cannot_reach_the_library() {
    let mut options = PlannerOptions::default();
    options.struct_size = u32::MAX;
    Planner::new(&options, None).unwrap();
    let mut scenario = Scenario::default();
    scenario.struct_size = 0;
    Queue::new(&scenario).unwrap();
}

#[test]
fn wrong_states_and_actions_are_refused() {
    let mut bin = Bin::new(4, 4).unwrap();
    let mut queue = Queue::new(&Scenario::default()).unwrap();
    let mut planner = Planner::new(&PlannerOptions::default(), None).unwrap();
    refused(planner.result(), Status::State, "");
    refused(planner.step(1), Status::State, "");
    let wrong = Action {
        op: op::PACK,
        item: 5,
        ..Action::default()
    };
    refused(apply(&mut bin, &mut queue, &[wrong]), Status::State, "0");
    refused(queue.remove_items(&[1]), Status::State, "0");
    planner.begin(&bin, &queue, &Budget::default()).unwrap();
    refused(planner.step(0), Status::Argument, "0");
}

#[test]
fn foreign_bytes_are_refused() {
    refused(load_snapshot(b"not a snapshot"), Status::Format, "byte 0");
    refused(load_snapshot(&[]), Status::Format, "");
    refused(Policy::load(&[1, 2, 3]), Status::Format, "byte 0");
    match Cell::load("{}") {
        Err(e) => assert!(
            matches!(e.status(), Status::Format | Status::Unsupported),
            "{e}"
        ),
        Ok(_) => panic!("an empty cell"),
    }
}

#[test]
fn bins_of_other_sizes_are_refused() {
    let policy = Policy::new("contact").unwrap();
    let (small, large) = (Bin::new(4, 4).unwrap(), Bin::new(5, 5).unwrap());
    let pairs = [(&small, 1, 1), (&large, 1, 1)];
    refused(policy.select_batch(&pairs), Status::Argument, "bin 1");
    refused(policy.select_batch(&[]), Status::Argument, "count 0");
    refused(policy.evaluate_batch(&[]), Status::Argument, "count 0");
    refused(policy.evaluate(&small, 1, 1), Status::Unsupported, "");
    refused(policy.save(), Status::Unsupported, "");
}

/// Only through `sys` can a second thread use a planner at all: to the safe types it is an error of
/// the compiler.
#[test]
fn a_second_thread_is_refused() {
    let mut planner = Planner::new(&PlannerOptions::default(), None).unwrap();
    let canceller = planner.canceller();
    let raw = planner.as_ptr() as usize;
    let bin = Bin::new(60, 60).unwrap();
    let mut queue = Queue::new(&"D-R40A10O2".parse().unwrap()).unwrap();
    for id in 0..40 {
        queue.push(&item(id, 3 + id % 7, 2 + id % 5)).unwrap();
    }
    planner
        .begin(&bin, &queue, &Budget::milliseconds(20_000.0))
        .unwrap();
    let refusal = std::thread::scope(|s| {
        let worker = s.spawn(move || {
            let done = planner.step(u64::MAX);
            (planner, done.err())
        });
        let mut refusal = None;
        while refusal.is_none() && !worker.is_finished() {
            let mut done = 0;
            // SAFETY: the planner lives: the worker gives it back.
            let status = unsafe { sys::pkc_planner_step(raw as *mut _, 1, &mut done) };
            if status == sys::PKC_E_BUSY {
                refusal = Some(Error::from_status(status));
            }
        }
        while !worker.is_finished() {
            canceller.cancel().unwrap();
            std::thread::yield_now();
        }
        // Either thread may be the one that is refused.
        let (_planner, other) = worker.join().unwrap();
        refusal.or(other)
    });
    let refusal = refusal.expect("one of them is refused");
    assert_eq!(refusal.status(), Status::Busy);
    assert!(refusal.message().contains("another thread"), "{refusal}");
}
