//! The controller as a co-simulation unit.

use counterpoise_controller::{Controller, READINGS};
use minijinja::{Environment, context};

use crate::fmi::{Unit, Variable};
use crate::{CodeOptions, Error, ExportSource, File, Provenance, c99, reading_fields};

/// Returns the controller as an FMI 3.0 co-simulation unit, in a folder of the options' name.
///
/// Inputs are the readings, the output is the control; the out-of-balance is a tunable parameter.
///
/// # Errors
/// As [`crate::c99()`].
pub fn controller_unit<'a>(
    source: impl Into<ExportSource<'a>>,
    provenance: &Provenance,
    options: &CodeOptions,
) -> Result<Vec<File>, Error> {
    let source = source.into();
    let controller = source.controller();
    let code = c99(source, provenance, options)?;
    let wanted = [format!("{}.h", options.name), format!("{}.c", options.name)];
    let own = code.into_iter().filter(|file| wanted.contains(&file.name));
    let placed = own.map(|file| File { name: format!("{}/sources/{}", options.name, file.name), ..file });
    let mut variables = vec![Variable::time()];
    variables.extend(
        reading_fields(controller)
            .iter()
            .zip(UNITS)
            .map(|(field, unit)| Variable::input(field.0, unit, field.1)),
    );
    variables.push(Variable::output("control_v", "V", "control, held from sample to sample"));
    let design = controller.parts().design_out_of_balance_kg_m;
    let says = "out-of-balance that the controller is told";
    variables.push(Variable::parameter("out_of_balance_kg_m", "kg.m", says, design));
    let says = "flags of the last sample, as NAME_status in the header says";
    variables.push(Variable::output("status", "1", says));
    variables.push(Variable::output("replaced", "1", "readings that were replaced by the last good one"));
    let unit = Unit {
        name: &options.name,
        description: "discrete controller of a stabilised, out-of-balance servo mechanism",
        tool: &provenance.generator,
        provenance: &provenance.header(source),
        variables: &variables,
        period_s: controller.sample_period_s(),
        behaviour: behaviour(&options.name, controller)?,
    };
    Ok(placed.chain(unit.files()?).collect())
}

/// Units of the readings.
const UNITS: [&str; READINGS] = ["rad/s", "rad/s", "rad/s", "m/s2", "rad/s", "rad", "m/s2"];

fn behaviour(name: &str, controller: &Controller) -> Result<String, Error> {
    let (period_s, fields) = (controller.sample_period_s(), reading_fields(controller));
    let data = context! {
        name,
        real => format!("{name}_real"),
        period => format!("{period_s:?}"),
        readings => fields.clone(),
        control => fields.len() + 1,
        setting => fields.len() + 2,
        status => fields.len() + 3,
        replaced => fields.len() + 4,
    };
    Ok(Environment::new().render_str(include_str!("../../templates/fmu_controller.c.jinja"), data)?)
}
