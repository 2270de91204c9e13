//! Checks of a controller's parts.

use std::collections::HashSet;

use counterpoise_lti::{StateSpace, Timebase};

use crate::range_checks::{NumberRequirement, at_least_0, count, require, require_finite, require_positive};
use crate::signal::{HUB_POSITION, HUB_RATE};
use crate::tolerance::{HIGHEST_ELEVATION_RAD, LONGEST_WINDOW, SAME_PERIOD};
use crate::words;
use crate::{
    DemandLimit, Error, Estimator, FrictionObserver, Learning, LevelLearning, ObserverLaw, Parts, Path,
    PathSignal, Programs, Scaling,
};

/// Names that target code uses itself, beside the words of its languages.
const RESERVED: [&str; 9] = ["real", "states", "readings", "guard", "core", "taken", "total", "c", "in_"];

/// Runs all checks.
pub fn check_parts(parts: &Parts) -> Result<(), Error> {
    numbers(parts)?;
    names(parts)?;
    corrections(parts)?;
    projection(parts)?;
    if let Some(prefilter) = &parts.prefilter {
        system("prefilter", prefilter, 1, parts.sample_period_s)?;
    }
    match parts.demand_limit {
        Some(DemandLimit::Error(most)) => require_positive("limit of the position error (rad or m)", most)?,
        Some(DemandLimit::Rate(most)) => require_positive("largest rate of the demand (rad/s or m/s)", most)?,
        None => {}
    }
    parts.paths.iter().try_for_each(|each| path(each, parts))?;
    parts.observers.iter().try_for_each(observer)?;
    parts.level_learning.as_ref().map_or(Ok(()), level_learning)?;
    drive_curve(&parts.drive_curve)?;
    parts.estimator.as_ref().map_or(Ok(()), estimator)
}

fn drive_curve(points: &[[f64; 2]]) -> Result<(), Error> {
    for column in 0..2 {
        let what = ["volts of a linear drive (V)", "control of the drive's curve (V)"][column];
        check_rising(what, points, column)?;
        points.first().map_or(Ok(()), |point| require_positive(what, point[column]))?;
    }
    Ok(())
}

fn numbers(parts: &Parts) -> Result<(), Error> {
    let (low, high) = parts.out_of_balance_range_kg_m;
    let design = parts.design_out_of_balance_kg_m;
    require_positive("sample period (s)", parts.sample_period_s)?;
    require_positive("control limit (V)", parts.limit_v)?;
    parts.reading_limits.iter().try_for_each(|limit| require_positive("limit of a reading", *limit))?;
    require_finite("bias (V/(kg m))", parts.bias_v_per_kg_m)?;
    at_least_0("transfer time (s)", parts.transfer_time_s)?;
    require_finite("lowest out-of-balance (kg m)", low)?;
    require_finite("highest out-of-balance (kg m)", high)?;
    let inside = low <= design && design <= high;
    require(
        "design out-of-balance (kg m)",
        design,
        NumberRequirement { holds: inside, words: "inside the range that may be set" },
    )
}

/// Checks that every state, input and local of a program has a name of its own.
pub fn check_distinct(programs: &Programs) -> Result<(), Error> {
    for program in [&programs.step, &programs.set_out_of_balance] {
        let mut seen = HashSet::new();
        let states = programs.states.iter().map(|group| &group.name);
        for name in states.chain(&program.inputs).chain(&program.locals) {
            if !seen.insert(name) {
                let problem = "would stand for two things in target code: rename a path or an observer";
                return Err(Error::Name { name: name.clone(), problem });
            }
        }
    }
    Ok(())
}

fn names(parts: &Parts) -> Result<(), Error> {
    let paths = parts.paths.iter().map(|path| path.name.as_str());
    let all: Vec<&str> = paths.chain(parts.observers.iter().map(|observer| observer.name.as_str())).collect();
    for (i, name) in all.iter().enumerate() {
        let problem = name_problem(name).or_else(|| all[..i].contains(name).then_some("is used twice"));
        if let Some(problem) = problem {
            return Err(Error::Name { name: (*name).to_owned(), problem });
        }
    }
    Ok(())
}

fn name_problem(name: &str) -> Option<&'static str> {
    let lower = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    let taken = crate::lowering::OWN_NAMES.contains(&name) || crate::READING_NAMES.contains(&name);
    match name.chars().next() {
        None => Some("is empty"),
        Some(first) if !first.is_ascii_lowercase() => Some("must start with a lower-case letter"),
        _ if !name.chars().all(lower) => Some("may hold only a to z, 0 to 9 and _"),
        _ if name.len() > 24 => Some("is longer than 24 characters"),
        _ if RESERVED.contains(&name) || words::is_word(name) || taken => {
            Some("is a word of the target code")
        }
        _ => None,
    }
}

fn corrections(parts: &Parts) -> Result<(), Error> {
    for (i, each) in parts.corrections.iter().enumerate() {
        let twice = parts.corrections[..i].iter().any(|other| other.reading == each.reading);
        let known = each.reading < parts.reading_count() && !twice;
        require(
            "corrected reading",
            each.reading as f64,
            NumberRequirement { holds: known, words: "a reading's index, corrected once" },
        )?;
        require_finite("correction's gain", each.gain)?;
        require_finite("correction's offset", each.offset)?;
    }
    Ok(())
}

fn projection(parts: &Parts) -> Result<(), Error> {
    let Some(projection) = parts.projection else { return Ok(()) };
    let angle = projection.design_angle_rad;
    let inside = angle.abs() <= HIGHEST_ELEVATION_RAD;
    require(
        "elevation of the projection's design (rad)",
        angle,
        NumberRequirement { holds: inside, words: "within +/- 1.6" },
    )?;
    projection
        .pitch_washout_s
        .map_or(Ok(()), |time_s| require_positive("washout of the platform's pitch angle (s)", time_s))?;
    let Some(reading) = projection.angle_reading else { return Ok(()) };
    let is_angle = reading == HUB_RATE || reading == HUB_POSITION;
    let words = "the hub's position, or the loop's own sensor where that is a position";
    require("reading of the projection's angle", reading as f64, NumberRequirement { holds: is_angle, words })
}

fn path(path: &Path, parts: &Parts) -> Result<(), Error> {
    system(&path.name, &path.system, path.inputs.len(), parts.sample_period_s)?;
    count(&path.name, "anti-windup gains for states", path.anti_windup.len(), path.system.order())?;
    for gain in &path.anti_windup {
        require_finite(&format!("anti-windup gain of path '{}'", path.name), *gain)?;
    }
    match path.scaling {
        Scaling::Fixed => Ok(()),
        Scaling::WithOutOfBalance => {
            let design = parts.design_out_of_balance_kg_m;
            require(
                "design out-of-balance (kg m)",
                design,
                NumberRequirement { holds: design != 0.0, words: "other than 0 where a path scales with it" },
            )
        }
        Scaling::Scheduled { below_kg_m, at_kg_m, above_kg_m } => {
            let increasing = below_kg_m.is_none_or(|below| below.is_finite() && below < at_kg_m)
                && above_kg_m.is_none_or(|above| above.is_finite() && at_kg_m < above);
            let wrong = || Error::Schedule {
                path: path.name.clone(),
                below: below_kg_m,
                at: at_kg_m,
                above: above_kg_m,
            };
            if increasing && at_kg_m.is_finite() { Ok(()) } else { Err(wrong()) }
        }
    }
}

fn system(name: &str, system: &StateSpace, inputs: usize, period_s: f64) -> Result<(), Error> {
    StateSpace::new(system.A.clone(), system.B.clone(), system.C.clone(), system.D.clone(), system.timebase)?;
    count(name, "inputs of the system", system.inputs(), inputs)?;
    count(name, "outputs of the system", system.outputs(), 1)?;
    match system.timebase {
        Timebase::Discrete { period_s: own } if (own - period_s).abs() <= SAME_PERIOD * period_s => Ok(()),
        other => Err(Error::Timebase { path: name.to_owned(), found: other.to_string(), period_s }),
    }
}

fn level_learning(learning: &LevelLearning) -> Result<(), Error> {
    at_least_0("lowest level of the friction (1)", learning.lowest)?;
    let range = NumberRequirement {
        holds: learning.highest >= learning.lowest && learning.highest.is_finite(),
        words: "at least the lowest level, and finite",
    };
    require("highest level of the friction (1)", learning.highest, range)?;
    let part = NumberRequirement { holds: (0.0..=1.0).contains(&learning.cancelled), words: "from 0 to 1" };
    require("cancelled part of the friction (1)", learning.cancelled, part)?;
    require_positive("gain of the learnt level (1/s)", learning.gain_per_s)?;
    require_positive("volts of the sliding friction (V)", learning.volts)?;
    require_positive("rate above which friction slides (rad/s)", learning.sliding_rate_rad_s)?;
    require_positive("rate scale of the learnt level (rad/s)", learning.rate_scale_rad_s)
}

fn observer(observer: &FrictionObserver) -> Result<(), Error> {
    let name = &observer.name;
    require_positive(&format!("Coulomb level of '{name}' (N m)"), observer.coulomb_nm)?;
    at_least_0(&format!("rest stiffness of '{name}' (N m/rad)"), observer.rest_stiffness_nm_rad)?;
    require_finite(&format!("gain of '{name}' (V/(N m))"), observer.volts_per_nm)?;
    require_finite(&format!("viscous gain of '{name}' (V s/rad)"), observer.viscous_v_s_rad)?;
    if !observer.level.is_empty() {
        check_rising(&format!("speeds of the level of '{name}' (rad/s)"), &observer.level, 0)?;
        for point in &observer.level {
            require_positive(&format!("level of '{name}' over its Coulomb level"), point[1])?;
        }
    }
    law(observer)?;
    rate(observer.rate)
}

fn law(observer: &FrictionObserver) -> Result<(), Error> {
    let name = &observer.name;
    let held =
        || require_positive(&format!("rest stiffness of '{name}' (N m/rad)"), observer.rest_stiffness_nm_rad);
    let damped = |damping| at_least_0(&format!("damping of '{name}' (N m s/rad)"), damping);
    let soft = |rate| require_positive(&format!("rate of the sign of '{name}' (rad/s)"), rate);
    match observer.law {
        ObserverLaw::Dahl => Ok(()),
        ObserverLaw::DahlPower { exponent } => {
            require_positive(&format!("exponent of '{name}'"), exponent).and_then(|()| held())
        }
        ObserverLaw::Lugre { damping_nm_s_rad } => damped(damping_nm_s_rad).and_then(|()| held()),
        ObserverLaw::ResetIntegrator { static_ratio, damping_nm_s_rad } => {
            require(
                &format!("static ratio of '{name}'"),
                static_ratio,
                NumberRequirement { holds: static_ratio >= 1.0, words: "1 or more" },
            )?;
            damped(damping_nm_s_rad).and_then(|()| held())
        }
        ObserverLaw::Sliding { sign_rate_rad_s } => soft(sign_rate_rad_s),
        ObserverLaw::Walrath { sign_rate_rad_s, time_constant_s } => {
            require_positive(&format!("time constant of '{name}' (s)"), time_constant_s)?;
            soft(sign_rate_rad_s)
        }
    }
}

/// Checks that the entries of a column rise.
fn check_rising(what: &str, points: &[[f64; 2]], column: usize) -> Result<(), Error> {
    for pair in points.windows(2) {
        let (before, after) = (pair[0][column], pair[1][column]);
        require(
            what,
            after,
            NumberRequirement { holds: after > before && after.is_finite(), words: "above the one before" },
        )?;
    }
    points.first().map_or(Ok(()), |point| at_least_0(what, point[column]))
}

fn rate(signal: PathSignal) -> Result<(), Error> {
    let is_rate = matches!(
        signal,
        PathSignal::Demand
            | PathSignal::HubRate
            | PathSignal::MotorRate
            | PathSignal::RelativeRate
            | PathSignal::PlatformRate
    );
    require("signal of a friction model", f64::NAN, NumberRequirement { holds: is_rate, words: "a rate" })
}

fn estimator(estimator: &Estimator) -> Result<(), Error> {
    require_finite("gravity (m/s^2)", estimator.gravity_m_s2)?;
    require_positive("half rate (rad/s)", estimator.half_rate_rad_s)?;
    learning(estimator)?;
    let volts = estimator.volts_per_kg_m_s2;
    require(
        "volts for a kg m at 1 m/s^2",
        volts,
        NumberRequirement { holds: volts.is_finite() && volts != 0.0, words: "finite and not 0" },
    )?;
    at_least_0("hold band (kg m)", estimator.hold_band_kg_m)?;
    let limit = estimator.rate_limit_kg_m_s;
    require("rate limit (kg m/s)", limit, NumberRequirement { holds: limit > 0.0, words: "positive" })?;
    rate(estimator.rate)
}

fn learning(estimator: &Estimator) -> Result<(), Error> {
    match &estimator.learning {
        Learning::Gradient { step, scale } => {
            require(
                "adaptation step",
                *step,
                NumberRequirement { holds: *step > 0.0 && *step < 2.0, words: "in 0 < step < 2" },
            )?;
            scale.iter().try_for_each(|scale| at_least_0("scale of an estimated parameter", *scale))
        }
        Learning::Mean { window_samples } => {
            let samples = f64::from(*window_samples);
            require(
                "window (samples)",
                samples,
                NumberRequirement {
                    holds: (1.0..=LONGEST_WINDOW).contains(&samples),
                    words: "from 1 to 1000000",
                },
            )?;
            let gravity = estimator.gravity_m_s2;
            require(
                "gravity (m/s^2)",
                gravity,
                NumberRequirement {
                    holds: gravity != 0.0,
                    words: "other than 0 for the mean: it goes by gravity",
                },
            )
        }
        Learning::Squares { forget, dead_band_m_s2, deviation, filter_s, inertia_v_s2_rad } => {
            require(
                "what a sample keeps",
                *forget,
                NumberRequirement { holds: *forget > 0.0 && *forget < 1.0, words: "in 0 < forget < 1" },
            )?;
            at_least_0("dead-band (m/s^2)", *dead_band_m_s2)?;
            at_least_0("filter of the estimator (s)", *filter_s)?;
            inertia_v_s2_rad.iter().try_for_each(|one| require_finite("inertia (V s^2/rad)", *one))?;
            deviation.iter().try_for_each(|one| require_positive("deviation of an estimated parameter", *one))
        }
    }
}
