//! The nonlinear plant as a co-simulation unit: all the physics that the simulator has.

use counterpoise_models::plant::Plant;
use minijinja::{Environment, context};

use crate::fmi::{Unit, Variable};
use crate::fmi::{free_functions, loads, machine};
use crate::tolerance::{MOST_BRISTLES, MOST_DELAY_SAMPLES};
use crate::{Error, File, Provenance, check_name};

/// A plant unit that was asked for.
#[derive(Debug, Clone, Copy)]
pub struct PlantUnit<'a> {
    /// The plant.
    pub plant: &'a Plant,
    /// Name of the unit: a lower-case identifier.
    pub name: &'a str,
}

/// Why a plant has no unit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlantUnitError {
    /// More than the unit's fixed memory holds.
    #[error("{what} = {value}: the generated plant keeps at most {most}")]
    Memory {
        /// The name of what there is too much of.
        what: &'static str,
        /// Number that there is.
        value: f64,
        /// Number that the unit holds.
        most: f64,
    },
    /// The unit could not be written.
    #[error(transparent)]
    Export(#[from] Error),
}

/// Returns the nonlinear plant as an FMI 3.0 co-simulation unit in C99 (with the mathematical library), in a folder of
/// its name.
///
/// It holds what [`counterpoise_simulate`] simulates: amplifier with limits, map and dead zone or a current source; armature,
/// cogging, torque ripple; gear with backlash, ripple and loss; the structure with its modes, gravity, spring and hose; every law
/// of friction, also those that truly stick; sensors with dynamics, faults and delays; the delay of the control. Inputs: control,
/// heave, pitch rate, and surge where a sensor feels it. Outputs: readings without noise or quantisation, true rates, current. The equations are those of the
/// models, solved by another method: Dormand and Prince's pair with the instants of switching found.
///
/// # Errors
/// [`PlantUnitError::Memory`] if a delay or a number of bristles is larger than the unit's memory, [`PlantUnitError::Export`]
/// for a bad name.
pub fn plant_unit(asked: PlantUnit, provenance: &Provenance) -> Result<Vec<File>, PlantUnitError> {
    let PlantUnit { plant, name } = asked;
    check_name(name)?;
    let past = machine::count_delayed_values(plant);
    let bonds = machine::bristles(plant);
    check_memory("delay in samples", past as f64, MOST_DELAY_SAMPLES)?;
    check_memory("number of bristles", bonds as f64, MOST_BRISTLES)?;
    let period_s = plant.parameters().interface.sample_period_s;
    let (learned, errors) = (free_functions::functions(plant), free_functions::sensor_errors(plant));
    let data = context! {
        name, NAME => name.to_uppercase(), provenance => provenance.lines(),
        period => format!("{period_s:?}"), parts => machine::shortest_parts(plant),
        bonds => bonds.max(1), past, states => machine::states(plant),
        kind => context! { cylinder => loads::cylinder(plant), ..machine::kind(plant) },
        tables => [learned.as_slice(), &errors].concat(), learned, errors,
        loads => loads::loads(plant), limits => loads::limits(plant),
        friction => include_str!("../../templates/plant_friction.c.jinja"),
        parameters => machine::parameters(plant), ripples => machine::ripples(plant),
        ideal_current => machine::ideal_current(plant), modes => machine::modes(plant),
        map => machine::map(plant), joints => machine::joints(plant), sensors => machine::sensors(plant),
        rest => machine::rest_states(plant), sizes => machine::sizes(plant), reversal => machine::POWER_REVERSAL_RATE,
    };
    let mut environment = Environment::new();
    environment
        .add_template("loads", include_str!("../../templates/plant_loads.c.jinja"))
        .map_err(Error::from)?;
    environment
        .add_template("drive", include_str!("../../templates/plant_drive.c.jinja"))
        .map_err(Error::from)?;
    let fill = |ending: &str, template: &str| -> Result<File, Error> {
        let text = environment.render_str(template, &data)?.trim_end().to_owned() + "\n";
        Ok(File { name: format!("{name}/sources/{name}.{ending}"), text })
    };
    let mut files = vec![
        fill("h", include_str!("../../templates/plant.h.jinja"))?,
        fill("c", include_str!("../../templates/plant.c.jinja"))?,
    ];
    let behaviour = environment.render_str(include_str!("../../templates/fmu_plant.c.jinja"), &data);
    let unit = Unit {
        name,
        description: DESCRIPTION,
        tool: &provenance.generator,
        provenance: &provenance.lines(),
        variables: &variables(plant),
        period_s,
        behaviour: behaviour.map_err(Error::from)?,
    };
    files.extend(unit.files()?);
    Ok(files)
}

/// The description of the unit, and the place of errors of sampling. The unit is exact at its communication points; when they are, and whether one is
/// missed, is the importer's choice, so a jitter inside the unit would be added to the importer's own.
const DESCRIPTION: &str = "nonlinear plant of a stabilised, out-of-balance servo mechanism; outputs are sensor signals before sampling: the \
    importing tool adds what belongs to the sampling side (noise, drift, converter steps and missing codes to the outputs; jitter, late and \
    missed samples by its communication points)";

fn check_memory(what: &'static str, value: f64, most: f64) -> Result<(), PlantUnitError> {
    if value <= most { Ok(()) } else { Err(PlantUnitError::Memory { what, value, most }) }
}

fn variables(plant: &Plant) -> Vec<Variable> {
    let local =
        |name, unit, says| Variable { causality: "local", start: None, ..Variable::output(name, unit, says) };
    let mut all = vec![
        Variable::time(),
        Variable::input("control_v", "V", "control after the output converter, held over a step"),
        Variable::input("heave_m_s2", "m/s2", "upward acceleration of the pivot, without gravity"),
        Variable::input("pitch_rate_rad_s", "rad/s", "pitch rate of the platform"),
        Variable::output("hub_rate_rad_s", "rad/s", "hub gyroscope"),
        Variable::output("platform_rate_rad_s", "rad/s", "platform gyroscope"),
        Variable::output("platform_accel_m_s2", "m/s2", "platform accelerometer"),
        Variable::output("motor_rate_rad_s", "rad/s", "motor tachometer"),
        Variable::output("hub_position_rad", "rad", "hub angle relative to the platform"),
        Variable::output("true_hub_rate_rad_s", "rad/s", "hub rate"),
        Variable::output("true_tip_rate_rad_s", "rad/s", "tip rate"),
        Variable::output("current_a", "A", "armature current"),
        local("last_heave_m_s2", "m/s2", "heave of the step before"),
        local("last_pitch_rate_rad_s", "rad/s", "pitch rate of the step before"),
    ];
    let sensors = &plant.parameters().sensors;
    if sensors.reads_surge() {
        all.push(Variable::input(
            "surge_m_s2",
            "m/s2",
            "forward acceleration of the pivot, along an axis that stays level",
        ));
        all.push(local("last_surge_m_s2", "m/s2", "surge of the step before"));
    }
    if sensors.surge_accelerometer.is_some() {
        all.push(Variable::output("platform_surge_m_s2", "m/s2", "second platform accelerometer (surge)"));
    }
    all
}
