//! Error against step for every law of friction and for contact, against the classical Runge-Kutta method.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::{Plant, reference};
use counterpoise_simulate::convergence::{convergence_cases, study_convergence};

/// Returns what the error must show: the least order with steps as they are, and, with events found, the most that it may be at the longest
/// step (eight milliseconds) and at the shortest (an eighth).
fn demanded_orders(name: &str) -> (f64, [f64; 2]) {
    match name {
        // its steps and instants are exact
        "Coulomb" | "Coulomb with stiction" => (0.0, [2e-9, 2e-9]),
        "Karnopp" => (1.0, [1e-7, 1e-8]),
        "Tustin" | "Gaussian" | "exponential" | "Lorentzian" | "polynomial" => (1.0, [3e-6, 5e-8]),
        "Dahl" | "Dahl, exponent 2" => (2.5, [1e-5, 1e-8]),
        "LuGre" | "Walrath" => (1.9, [1e-4, 5e-7]),
        "reset integrator" => (1.5, [1e-5, 2e-7]),
        // a bond that snaps makes the torque jump, which its steps resolve to an eighth
        "bristles" => (1.0, [3e-3, 2e-4]),
        // the instants are found to a 2048th of a sample
        "contact" => (0.9, [3e-5, 5e-6]),
        other => panic!("{other} has no demand"),
    }
}

#[test]
fn every_law_and_contact_converge_to_a_second_method_by_their_order() {
    let plant = Plant::from_lumped(&reference::rig()).unwrap();
    let cases = convergence_cases(&plant).unwrap();
    assert_eq!(cases.len(), 15);
    for case in cases {
        let name = case.name;
        let found = study_convergence(&case.plant, case.control_v, 5).unwrap();
        println!("{name}: order {:.1}, second method {:.0e}", found.order(), found.second_method);
        println!(
            "    steps  {}\n    events {}",
            show_errors(&found.error),
            show_errors(&found.finding_events)
        );
        let (order, [longest, shortest]) = demanded_orders(name);
        assert!(found.second_method < 1e-9, "{name}: the second method errs by {:e}", found.second_method);
        assert!(found.order().is_nan() == (order == 0.0), "{name}: {}", found.order());
        assert!(order == 0.0 || found.order() > order, "{name}: {}", found.order());
        let (first, last) = (found.finding_events[0], found.finding_events[4]);
        assert!(first < longest && last < shortest, "{name}: {first:e} {last:e}");
    }
}

/// Over a factor of 64 in the step the error falls in proportion to it, whether the instants of contact are found or not: found,
/// they are on a grid of the sample period.
#[test]
fn the_error_of_contact_falls_in_proportion_to_the_step() {
    let plant = Plant::from_lumped(&reference::rig()).unwrap();
    let contact = convergence_cases(&plant).unwrap().pop().unwrap();
    let found = study_convergence(&contact.plant, contact.control_v, 7).unwrap();
    println!("steps  {}\nevents {}", show_errors(&found.error), show_errors(&found.finding_events));
    println!("orders {:.2} {:.2}", found.order(), found.order_finding_events());
    assert!(found.order() > 0.9 && found.order_finding_events() > 0.7);
    assert!(found.finding_events.iter().zip(&found.error).all(|(found, not)| 10.0 * found < *not));
}

fn show_errors(errors: &[f64]) -> String {
    errors.iter().map(|e| format!("{e:9.1e}")).collect()
}
