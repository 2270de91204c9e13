//! From requirements to weights, on the reference rig.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use crate::common;

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

use common::{rig, thesis_weights, weights};
use counterpoise_synth::{
    BandSpectrum, Design, DisturbanceChannel, Error, Requirements, Sampling, SearchEnding, SearchResult,
    SearchTask, Specification, Weight, design, search_specification, stabilisation_error, trade_off,
};

fn search_rig(start: &Specification, requirements: &Requirements, most: usize) -> SearchResult {
    let sampling = Sampling::new(1e-3, 10.0);
    let plant = rig();
    let task = SearchTask { plant: &plant, start, requirements, sampling: &sampling, most_trials: most };
    search_specification(&task, &mut |_| true).unwrap()
}

#[test]
fn far_off_weights_are_brought_to_the_requirements_and_reject_more_than_the_thesis_form() {
    let mut start = thesis_weights();
    start.feedback.error = Weight::Integral { gain: 3000.0, time_s: 1.0 };
    let requirements = Requirements::thesis();
    let found = search_rig(&start, &requirements, 120);
    assert_eq!(found.best.missed, 0.0, "{:?}", found.best.figures);
    let figures = found.best.figures;
    assert!(figures.gain_margin_db >= 12.0 && figures.phase_margin_deg >= 60.0 && figures.overshoot <= 0.13);
    assert_eq!(found.best.specification.heave, start.heave);
}

#[test]
fn the_default_weights_are_improved_within_the_requirements_and_always_alike() {
    let requirements = Requirements { ms: 1.4, ..Requirements::thesis() };
    let (first, second) =
        (search_rig(&weights(), &requirements, 60), search_rig(&weights(), &requirements, 60));
    assert_eq!(first, second);
    let start = search_rig(&weights(), &requirements, 1).best;
    assert!(first.best.missed == 0.0 && first.best.figures.rejection < start.figures.rejection);
}

#[test]
fn a_search_can_be_stopped_and_is_bounded() {
    let sampling = Sampling::new(1e-3, 10.0);
    let requirements = Requirements::thesis();
    let mut asked = 0;
    let mut go_on = |_: &_| {
        asked += 1;
        asked < 5
    };
    let (plant, start) = (rig(), weights());
    let task = SearchTask {
        plant: &plant,
        start: &start,
        requirements: &requirements,
        sampling: &sampling,
        most_trials: 1000,
    };
    let stopped = search_specification(&task, &mut go_on).unwrap();
    assert_eq!((stopped.ended, stopped.trials), (SearchEnding::Stopped, 5));
    assert_eq!(search_rig(&weights(), &requirements, 9).ended, SearchEnding::OutOfTrials);
}

#[test]
fn more_sensitivity_buys_more_rejection() {
    let sampling = Sampling::new(1e-3, 10.0);
    let requirements =
        Requirements { phase_margin_deg: 0.0, overshoot: 1.0, gain_margin_db: 6.0, ..Requirements::thesis() };
    let limits = [1.2, 1.4, 1.7];
    let (plant, start) = (rig(), weights());
    let task = SearchTask {
        plant: &plant,
        start: &start,
        requirements: &requirements,
        sampling: &sampling,
        most_trials: 60,
    };
    let curve = trade_off(&task, &limits, &mut |_| true).unwrap();
    for (found, limit) in curve.iter().zip(limits) {
        assert!(found.best.missed == 0.0 && found.best.figures.ms <= limit, "{:?}", found.best.figures);
    }
    assert!(curve.windows(2).all(|pair| pair[1].best.figures.rejection < pair[0].best.figures.rejection));
}

/// The share is that of the rate: by the expected motion it is the RMS rate with feedback over that without, in the band.
#[test]
fn rejection_of_the_expected_motion_is_the_share_of_its_rate_that_is_left() {
    let mut start = weights();
    let band_rad_s = [0.5, 200.0];
    let requirements =
        Requirements { spectrum: BandSpectrum::Expected, band_rad_s, ..Requirements::thesis() };
    let both = search_rig(&start, &requirements, 1).best.figures.rejection;
    let flat =
        search_rig(&start, &Requirements { band_rad_s, ..Requirements::thesis() }, 1).best.figures.rejection;
    start.pitch = None;
    let plant = rig();
    let design = design(&plant, &start).unwrap();
    let with = stabilisation_error(&plant, &design, DisturbanceChannel::Heave, 0.0).unwrap();
    let open = Design { substitute: Some(idle_feedback()), ..design };
    let without = stabilisation_error(&plant, &open, DisturbanceChannel::Heave, 0.0).unwrap();
    let heave = search_rig(&start, &requirements, 1).best.figures.rejection;
    println!("both {both}, flat {flat}, heave {heave}, {}", with / without);
    assert!((heave / (with / without) - 1.0).abs() < 0.05, "{heave} {}", with / without);
    assert!((flat / heave - 1.0).abs() > 0.1);
    start.heave = None;
    let sampling = Sampling::new(1e-3, 10.0);
    let task = SearchTask {
        plant: &plant,
        start: &start,
        requirements: &requirements,
        sampling: &sampling,
        most_trials: 1,
    };
    let none = search_specification(&task, &mut |_| true);
    assert!(matches!(none, Err(Error::System { what: "search by the expected motion", .. })), "{none:?}");
}

/// No feedback at all.
fn idle_feedback() -> StateSpace {
    StateSpace::gain(Mat::zeros(1, 2), Timebase::Continuous).unwrap()
}
