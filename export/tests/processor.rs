//! Processor in the loop: the generated C cross-compiled for Cortex-M4F and M7, run bare metal in QEMU. Answers are equal
//! to the last bit; instructions, flash, memory and stack of a step are counted.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

#[path = "support/target.rs"]
mod target;

use counterpoise_controller::{Controller, Number, READINGS};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::board::{CORES, TargetCore};
use counterpoise_export::{
    CodeOptions, File, FixedPointController, FixedRunner, Numbers, Precision, Ranges, c99, fixed_c99,
    plan_fixed_point,
};
use support::{
    RandomGenerator, Request, Target, complete_controller, equal_to_the_last_bit, folder, provenance,
    reference, requests, server, server_in, typical_controller, write,
};
use target::{build, cost, emulator, tools_are_there};

fn known_ranges(controller: &Controller) -> Ranges {
    let mut random = RandomGenerator(3);
    let history: Vec<[f64; READINGS]> =
        (0..2000).map(|_| random.readings().map(|value| 0.05 * value)).collect();
    Ranges::from_readings(controller, &[history], 4.0)
}

fn fixed_controller(controller: &Controller) -> FixedPointController {
    plan_fixed_point(controller, &known_ranges(controller), 1e-2, 2000).unwrap()
}

#[test]
fn a_step_costs_what_its_multiplications_need() {
    if !tools_are_there() {
        return;
    }
    let controller = typical_controller();
    let step = &controller.programs().step;
    let (multiplications, additions) = (step.multiplications(), step.additions());
    println!("one step: {multiplications} multiplications, {additions} additions");
    let exact = |options: CodeOptions| c99(Unverified(&controller), &provenance(), &options).unwrap();
    let kinds = [
        (Numbers::Single, exact(CodeOptions::single("axis"))),
        (Numbers::Double, exact(CodeOptions::double("axis"))),
        (
            Numbers::Fixed,
            fixed_c99(Unverified(&controller), &fixed_controller(&controller), &provenance(), "axis")
                .unwrap(),
        ),
    ];
    for core in &CORES {
        for (numbers, files) in &kinds {
            let cost = cost(core, "count", ("axis", *numbers), files);
            println!("{} {numbers:?}: {cost:?}", core.name);
            if *numbers == Numbers::Single {
                // One instruction each for product, sum and the load of its coefficient, one to store and one to load a
                // state; the rest is call, limits and addresses.
                let states = controller.programs().state_count();
                // The guard takes about 45 instructions a reading and 15 a state.
                let guard = controller.parts().reading_count() * 45 + states * 15;
                let needed = (2 * multiplications + additions + 2 * states + guard) as u64;
                let found = cost.step_instructions;
                assert!(found < 2000, "{cost:?}");
                assert!(found < needed + needed / 2 && found > needed / 2, "{cost:?} {needed}");
            }
            assert!(cost.flash_bytes < 16 * 1024 && cost.stack_bytes < 1024, "{cost:?}");
            assert!(cost.state_bytes <= 8 * controller.programs().state_count() as u64 + 96);
            assert!(cost.set_instructions < cost.step_instructions, "{cost:?}");
        }
    }
}

/// Builds a server of one controller for a core and gives its answers.
fn answers(
    core: &TargetCore,
    test: &str,
    files: &[File],
    main: &str,
    asked: &[(usize, Request)],
) -> Vec<f64> {
    let folder = folder(&format!("{test}_{}", core.machine));
    write(&folder, files);
    std::fs::write(folder.join("server.c"), main).unwrap();
    build(core, &folder, &["controller_0.c".into()], "server.c");
    Target::launch(&mut emulator(core, &folder)).ask_all(asked)
}

fn compare<N: Number>(core: &TargetCore, precision: Precision) {
    let (controllers, asked) = ([complete_controller()], requests(1, 600));
    let options = CodeOptions { name: "controller_0".into(), precision };
    let files = c99(Unverified(&controllers[0]), &provenance(), &options).unwrap();
    let main = server(&["controller_0".into()]);
    let found = answers(core, &format!("answers_{precision:?}"), &files, &main, &asked);
    equal_to_the_last_bit(&found, &reference::<N>(&controllers, &asked));
}

#[test]
fn floating_point_answers_are_equal_to_the_last_bit() {
    if !tools_are_there() {
        return;
    }
    for core in &CORES {
        compare::<f32>(core, Precision::Single);
        compare::<f64>(core, Precision::Double);
    }
}

#[test]
fn fixed_point_answers_are_equal() {
    if !tools_are_there() {
        return;
    }
    let fixed = fixed_controller(&typical_controller());
    let files = fixed_c99(Unverified(&fixed.controller), &fixed, &provenance(), "controller_0").unwrap();
    let main = server_in(&["controller_0".into()], |_| "int32_t".into());
    let mut random = RandomGenerator(8);
    let mut runner = FixedRunner::new(&fixed);
    let integers: Vec<[f64; READINGS]> =
        (0..600).map(|_| std::array::from_fn(|_| (2147483647.0 * random.signed_unit()).round())).collect();
    let asked: Vec<(usize, Request)> =
        integers.iter().map(|readings| (0, Request::Step(*readings))).collect();
    let expected: Vec<f64> = integers
        .iter()
        .map(|readings| runner.step_integers(&readings.map(|value| value as i64)) as f64)
        .collect();
    for core in &CORES {
        assert_eq!(answers(core, "answers_fixed", &files, &main, &asked), expected);
    }
}
