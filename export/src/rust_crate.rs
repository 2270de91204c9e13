//! The controller as a Rust crate.

use counterpoise_controller::Controller;
use counterpoise_controller::program::{OnRestart, Operation, Program, Slot, StateGroup};
use minijinja::{Environment, context};

use crate::guard::{flags, guard, mark_files};
use crate::print::{Dialect, Printer, literal, meaning, state};
use crate::vectors::{Vector, shipped_vectors};
use crate::{
    CodeOptions, Error, ExportSource, File, Precision, Provenance, check_name, check_range, reading_fields,
};

/// Returns the controller as a `no_std` Rust crate without dependencies and without `unsafe`: `Cargo.toml`,
/// `src/lib.rs` and `tests/vectors.rs`, the same arithmetic and the same vectors as [`crate::c99()`].
///
/// # Errors
/// As [`crate::c99()`].
pub fn rust_crate<'a>(
    source: impl Into<ExportSource<'a>>,
    provenance: &Provenance,
    options: &CodeOptions,
) -> Result<Vec<File>, Error> {
    let source = source.into();
    let controller = source.controller();
    check_name(&options.name)?;
    check_range(controller, options.precision)?;
    let data = data(controller, &provenance.header(source), options);
    let environment = Environment::new();
    let templates = [
        ("Cargo.toml", include_str!("../templates/cargo.toml.jinja")),
        ("src/lib.rs", include_str!("../templates/lib.rs.jinja")),
        ("tests/vectors.rs", include_str!("../templates/vectors.rs.jinja")),
    ];
    let fill = |(name, template): (&str, &str)| {
        let text = environment.render_str(template, &data)?.trim_end().to_owned() + "\n";
        Ok(File { name: format!("{}/{name}", options.name), text })
    };
    Ok(mark_files(templates.into_iter().map(fill).collect::<Result<_, Error>>()?))
}

fn data(controller: &Controller, provenance: &[String], options: &CodeOptions) -> minijinja::Value {
    let programs = controller.programs();
    let precision = options.precision;
    let printer = |program, input_prefix| Printer {
        dialect: Dialect::Rust,
        precision,
        programs,
        program,
        real: "Real",
        input_prefix,
    };
    let (step, set) = (printer(&programs.step, "readings."), printer(&programs.set_out_of_balance, ""));
    context! {
        name => options.name.as_str(),
        number => if precision == Precision::Double { "f64" } else { "f32" },
        provenance => provenance.to_vec(),
        readings => reading_fields(controller),
        states => state_fields(controller),
        start => start(controller, precision),
        restart => initial(controller, precision, OnRestart::Restart),
        keep => initial(controller, precision, OnRestart::Keep),
        flags => flags(controller),
        guard => guard(controller, precision, Dialect::Rust),
        step => step.body(),
        set => set.body(),
        reads_input => reads_input(&programs.step),
        period => literal(controller.sample_period_s(), precision, Dialect::Rust),
        limit => literal(controller.limit_v(), precision, Dialect::Rust),
        vectors => shipped_vectors(controller, precision).iter().map(|v| row(v, controller, precision)).collect::<Vec<_>>(),
    }
}

fn reads_input(program: &Program) -> bool {
    let reads = |operation: &Operation| operation.reads().iter().any(|slot| matches!(slot, Slot::Input(_)));
    program.operations().any(reads)
}

/// Declarations of the states with their meanings.
fn state_fields(controller: &Controller) -> Vec<(String, String)> {
    let kind = |length: Option<usize>| length.map_or("Real".to_owned(), |n| format!("[Real; {n}]"));
    let field = |group: &StateGroup| format!("{}: {}", group.name, kind(group.length));
    controller.programs().states.iter().map(|group| (field(group), meaning(group))).collect()
}

/// Field initialisers.
fn start(controller: &Controller, precision: Precision) -> Vec<String> {
    let number = |value: f64| literal(value, precision, Dialect::Rust);
    let groups = &controller.programs().states;
    groups
        .iter()
        .map(|group| match group.length {
            Some(n) => format!("{}: [0.0; {n}]", group.name),
            None => format!("{}: {}", group.name, number(group.initial.first().copied().unwrap_or(0.0))),
        })
        .collect()
}

/// Assignments that put states to their start.
fn initial(controller: &Controller, precision: Precision, which: OnRestart) -> Vec<String> {
    let programs = controller.programs();
    let groups = programs.states.iter().filter(|group| group.on_restart == which);
    groups
        .map(|group| match group.length {
            Some(n) => format!("self.{} = [0.0; {n}];", group.name),
            None => {
                let value = group.initial.first().copied().unwrap_or(0.0);
                let place = state(programs, group.first, Dialect::Rust);
                format!("{place} = {};", literal(value, precision, Dialect::Rust))
            }
        })
        .collect()
}

fn row(vector: &Vector, controller: &Controller, precision: Precision) -> String {
    let number = |value: f64| literal(value, precision, Dialect::Rust);
    let taken = vector.readings.iter().take(controller.parts().reading_count());
    let readings: Vec<String> = taken.map(|value| number(*value)).collect();
    let set =
        vector.set_out_of_balance_kg_m.map_or("None".to_owned(), |value| format!("Some({})", number(value)));
    format!("({set}, [{}], {})", readings.join(", "), number(vector.control_v))
}
