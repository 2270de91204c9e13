//! The table of designs on the reference rig: a minute and a half of processor time, so `.ci/evidence` runs it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;

use counterpoise_pipeline::studies::designs::{ComparisonRequest, DesignRow, design_table};
use counterpoise_project::Purpose;
use counterpoise_tests::examples;

fn motion(row: &DesignRow) -> f64 {
    row.nonlinear.and_then(|run| run.motion.value).expect("a run on the road")
}

#[test]
fn on_the_rig_tuned_structures_beat_the_h2_feedback_within_its_own_limits_and_none_beats_the_bound() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml");
    let project = examples::resolve_example(&path, Purpose::Compare).unwrap();
    let world = examples::world(&path);
    let table = design_table(&project, &ComparisonRequest::default(), &world).unwrap();
    let named = |name: &str| table.rows.iter().find(|row| row.name.contains(name)).expect(name);
    let (own, pi, notches) = (named("own: three-part H2"), named("tuned PI with a lag"), named("2 notches"));
    let bound = named("best linear feedback").linear.unwrap().disturbed.residual;
    let limits = own.linear.unwrap();
    for row in [pi, notches] {
        let found = row.linear.unwrap();
        assert_eq!(row.missed, 0.0, "{row:?}");
        assert!(found.max_sensitivity <= 1.001 * limits.max_sensitivity, "{row:?}");
        assert!(found.noise_gain <= 1.001 * limits.noise_gain, "{row:?}");
        assert!(found.disturbed.residual < limits.disturbed.residual, "{row:?}");
        assert!(found.disturbed.residual > 0.995 * bound, "{row:?} against {bound}");
        assert!(motion(row) < motion(own), "{row:?}");
    }
    // The H2 feedback does not lose to a tuned PI any more once its weights are tuned for the same motion.
    let weights = named("weights tuned");
    assert!(weights.missed == 0.0 && weights.weights.is_some(), "{weights:?}");
    assert!(
        weights.linear.unwrap().disturbed.residual < pi.linear.unwrap().disturbed.residual,
        "{weights:?}"
    );
    assert!(weights.linear.unwrap().disturbed.residual > 0.995 * bound, "{weights:?} against {bound}");
    assert!(motion(weights) < motion(pi), "{weights:?}");
    assert!(notches.linear.unwrap().disturbed.residual <= 1.001 * pi.linear.unwrap().disturbed.residual);
    // More blocks are not bought with steps or sines: within 2 % of the PI there.
    let (fewer, more) = (pi.nonlinear.unwrap(), notches.nonlinear.unwrap());
    assert!(more.step.value < 1.02 * fewer.step.value && more.sines.value < 1.02 * fewer.sines.value);
}
