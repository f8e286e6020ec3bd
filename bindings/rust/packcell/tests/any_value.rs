//! Any numbers anywhere, through the safe functions: a result or an error, never a crash.

use packcell::*;

const NUMBERS: [i32; 16] = [
    i32::MIN,
    i32::MIN + 1,
    -65_536,
    -129,
    -2,
    -1,
    0,
    1,
    2,
    3,
    5,
    127,
    128,
    129,
    65_536,
    i32::MAX,
];

const REALS: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN_POSITIVE,
    -1.0,
    -0.0,
    0.0,
    1e-9,
    0.5,
    30.0,
    1e6,
];

/// The same numbers in every run.
struct Draw(u64);

impl Draw {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) as usize % n
    }

    fn int(&mut self) -> i32 {
        NUMBERS[self.below(NUMBERS.len())]
    }

    fn real(&mut self) -> f64 {
        REALS[self.below(REALS.len())]
    }

    fn item(&mut self) -> Item {
        Item {
            id: self.int(),
            w: self.int(),
            h: self.int(),
            flags: self.below(5) as u32,
        }
    }

    fn action(&mut self) -> Action {
        Action {
            op: self.below(6) as i32,
            item: self.int(),
            x: self.int(),
            y: self.int(),
            rot: self.int(),
            arm: self.int(),
        }
    }

    fn many<T>(&mut self, mut one: impl FnMut(&mut Draw) -> T) -> Vec<T> {
        (0..self.below(5)).map(|_| one(self)).collect()
    }
}

#[test]
fn bins_queues_and_policies() {
    let mut d = Draw(1);
    let mut bin = Bin::new(5, 7).unwrap();
    let mut queue = Queue::new(&"D-R5A3O1".parse().unwrap()).unwrap();
    let policy = Policy::new("default").unwrap();
    for _ in 0..3_000 {
        let _ = Bin::new(d.int(), d.int());
        let _ = bin.block(d.int(), d.int(), d.int(), d.int());
        let _ = bin.pack(&d.item(), d.int(), d.int(), d.int());
        let _ = bin.contact(d.int(), d.int(), d.int(), d.int());
        let _ = bin.feasible(d.int(), d.int());
        let _ = bin.unpack(d.int());
        let _ = queue.push(&d.item());
        let _ = queue.put_in_buffer(&d.item(), d.int());
        let _ = queue.set_alpha_left(d.int());
        let _ = queue.remove(d.int());
        let _ = queue.remove_items(&d.many(Draw::int));
        let actions = d.many(Draw::action);
        let _ = plan_hash(&actions);
        let _ = apply(&mut bin, &mut queue, &actions);
        let _ = policy.select(&bin, d.int(), d.int());
        let _ = policy.evaluate(&bin, d.int(), d.int());
        let _ = policy.evaluate_batch(&[(&bin, d.int(), d.int()), (&bin, 1, 1)]);
        let _ = exact_pack(&bin, &d.many(Draw::item), true, &Budget::nodes(50));
        let _ = bound_in_order(&bin, &d.many(Draw::item), false, &Budget::nodes(50));
        if d.below(50) == 0 {
            bin.clear().unwrap();
            queue = Queue::new(&queue.scenario().unwrap()).unwrap();
        }
    }
    let bytes = save_snapshot(&bin, &queue).unwrap();
    for at in 0..bytes.len() {
        let _ = load_snapshot(&bytes[..at]);
        let mut wrong = bytes.clone();
        wrong[at] ^= 1 << d.below(8);
        let _ = load_snapshot(&wrong);
    }
}

#[test]
fn options_and_cells() {
    let mut d = Draw(2);
    for _ in 0..1_000 {
        let mut scenario = Scenario::default();
        scenario.robots = d.int();
        scenario.recognized = d.int();
        scenario.accessible = d.int();
        scenario.overlap = d.int();
        let _ = scenario.to_string();
        let _ = Queue::new(&scenario);
        let mut grid = Grid::default();
        grid.bin_w = d.real();
        grid.margin = d.real();
        grid.cell = d.real();
        grid.clearance = d.real();
        let _ = grid.bin();
        let _ = grid.item(d.real(), d.real());
        let _ = grid.centre(d.int(), d.int(), d.int(), d.int());
        let mut options = GeneratorOptions::default();
        options.kind = d.int();
        options.w = d.int();
        options.h = d.int();
        options.mean = d.real();
        options.sigma = d.real();
        let _ = Generator::new(&options);
    }
    let cell = match Cell::new("ur5e") {
        Err(e) if e.status() == Status::Unsupported => return,
        cell => cell.unwrap(),
    };
    let mut schedule = Schedule::new(&cell, &Scenario::default(), Mode::Coordinated).unwrap();
    let (bin, queue) = (
        Bin::new(10, 10).unwrap(),
        Queue::new(&Scenario::default()).unwrap(),
    );
    for _ in 0..1_000 {
        let pose = [d.real(), d.real(), d.real(), d.real()];
        let _ = cell.inverse(d.int(), &pose);
        let _ = cell.forward(d.int(), &[d.real(); 6]);
        let _ = cell.allocate(&queue, &mut d.many(Draw::action));
        let _ = schedule.add_step(&bin, &queue, &d.many(Draw::action));
        let _ = schedule.put_aside(d.int(), d.real());
        let _ = schedule.sample(d.int(), d.real());
        let mut options = SimulationOptions::default();
        options.hertz = d.int();
        options.sigma = d.real();
        let _ = schedule.simulate(&options);
        let _ = schedule.write_trace(None, Trace::Joints(d.int(), d.real()), "/no/such/folder/f");
    }
}

#[test]
fn text_of_any_kind() {
    for text in [
        "",
        "\0",
        "a\0b",
        "\u{ffff}",
        "D-R",
        "%s%n",
        &"x".repeat(100_000),
    ] {
        assert!(text.parse::<Scenario>().is_err());
        assert!(Policy::new(text).is_err());
        assert!(Policy::load(text.as_bytes()).is_err());
        assert!(Policy::load_file(text).is_err());
        assert!(Cell::new(text).is_err());
        assert!(Cell::load(text).is_err());
        assert!(Cell::load_file(text).is_err());
        assert!(GeneratorOptions::default().preset(text).is_err());
    }
}
