//! The controller in C99.

use counterpoise_controller::Controller;
use counterpoise_controller::program::{OnRestart, Operation, Program, Programs, Slot, StateGroup};
use minijinja::{Environment, context};

use crate::guard::{flags, guard, guard_bytes, guard_instructions, mark_files};
use crate::print::{Dialect, Printer, literal, meaning, state};
use crate::vectors::{Vector, shipped_vectors};
use crate::{
    CodeOptions, Error, ExportSource, File, Precision, Provenance, check_name, check_range, reading_fields,
};

/// Returns the controller as C99 source
///
/// | file | what it is |
/// |---|---|
/// | `NAME.h` | types, provenance, units, seven functions |
/// | `NAME.c` | the functions: no heap, no recursion, no global state, no library |
/// | `NAME_self_test.c` | vectors and a function that counts where the target answers otherwise; no library |
/// | `NAME_test.c` | a program that runs the self test and prints its outcome |
/// | `NAME_interrupt.c` | a block to paste into the sampling interrupt |
/// | `NAME_README.md` | how to put it to work |
///
/// # Errors
/// [`Error::Name`] for a name that is no lower-case identifier, [`Error::SingleRange`] for a coefficient that single
/// precision cannot hold.
pub fn c99<'a>(
    source: impl Into<ExportSource<'a>>,
    provenance: &Provenance,
    options: &CodeOptions,
) -> Result<Vec<File>, Error> {
    let source = source.into();
    let controller = source.controller();
    check_name(&options.name)?;
    check_range(controller, options.precision)?;
    let header = provenance.header(source);
    let board = provenance
        .converters
        .block(source.controller(), &|value| literal(value, options.precision, Dialect::C));
    let data = context! { board, ..data(controller, &header, options) };
    let environment = Environment::new();
    let data = with_guard(&environment, data)?;
    let templates = [
        (".h", include_str!("../templates/controller.h.jinja")),
        (".c", include_str!("../templates/controller.c.jinja")),
        ("_self_test.c", include_str!("../templates/self_test.c.jinja")),
        ("_test.c", include_str!("../templates/test.c.jinja")),
        ("_interrupt.c", include_str!("../templates/interrupt.c.jinja")),
        ("_README.md", include_str!("../templates/readme.md.jinja")),
    ];
    let fill = |(ending, template): (&str, &str)| {
        let text = environment.render_str(template, &data)?;
        Ok(File { name: format!("{}{ending}", options.name), text: text.trim_end().to_owned() + "\n" })
    };
    Ok(mark_files(templates.into_iter().map(fill).collect::<Result<_, Error>>()?))
}

/// Adds the texts that the files of floating and fixed point share.
pub(crate) fn with_guard(
    environment: &Environment<'_>,
    data: minijinja::Value,
) -> Result<minijinja::Value, Error> {
    let text =
        |template: &str| environment.render_str(template, &data).map(|text| text.trim_end().to_owned());
    let guard_header = text(include_str!("../templates/guard_header.h.jinja"))? + "\n";
    let same_set = text(include_str!("../templates/same_set.c.jinja"))? + "\n";
    let guard_calls = text(include_str!("../templates/guard_calls.c.jinja"))?;
    Ok(context! { guard_header, same_set, guard_calls, ..data })
}

fn data(controller: &Controller, provenance: &[String], options: &CodeOptions) -> minijinja::Value {
    let (name, programs) = (&options.name, controller.programs());
    let real = format!("{name}_real");
    let printer = |program, input_prefix| Printer {
        dialect: Dialect::C,
        precision: options.precision,
        programs,
        program,
        real: &real,
        input_prefix,
    };
    let number_bytes = if options.precision == Precision::Double { 8 } else { 4 };
    let (step, set) = (printer(&programs.step, "in->"), printer(&programs.set_out_of_balance, ""));
    context! {
        name,
        real => real.as_str(),
        NAME => name.to_uppercase(),
        number => if options.precision == Precision::Double { "double" } else { "float" },
        provenance => provenance.to_vec(),
        verified => line_with(provenance, "verified:"),
        hash => line_with(provenance, "project-hash:"),
        readings => reading_fields(controller),
        states => state_fields(controller),
        restart => initial(controller, options.precision, OnRestart::Restart),
        keep => initial(controller, options.precision, OnRestart::Keep),
        step => step.body(),
        set => set.body(),
        unused => unused_arguments(&programs.step),
        period => literal(controller.sample_period_s(), options.precision, Dialect::C),
        rate_hz => (1.0 / controller.sample_period_s()).round() as u64,
        limit => literal(controller.limit_v(), options.precision, Dialect::C),
        multiplications => programs.step.multiplications(),
        additions => programs.step.additions(),
        state_count => programs.state_count(),
        state_bytes => programs.state_count() * number_bytes + guard_bytes(controller, number_bytes),
        flags => flags(controller),
        guard => guard(controller, options.precision, Dialect::C),
        needed => instruction_count(controller),
        vectors => shipped_vectors(controller, options.precision).iter().map(|v| row(v, controller, options.precision)).collect::<Vec<_>>(),
    }
}

/// Instructions that a step needs where a product, a sum, a load and a store are one each: every product loads its
/// coefficient, every state is loaded and stored. The guard comes on top.
fn instruction_count(controller: &Controller) -> usize {
    let (step, states) = (&controller.programs().step, controller.programs().state_count());
    2 * step.multiplications() + step.additions() + 2 * states + guard_instructions(controller)
}

/// Returns the line of the header that begins with a word.
pub(crate) fn line_with(provenance: &[String], word: &str) -> String {
    provenance.iter().find(|line| line.starts_with(word)).cloned().unwrap_or_default()
}

/// Arguments of the step that it does not use.
fn unused_arguments(step: &Program) -> Vec<&'static str> {
    let touched = |operation: &Operation, wanted: fn(&Slot) -> bool| {
        wanted(&operation.into_slot()) || operation.reads().iter().any(wanted)
    };
    let touches = |wanted: fn(&Slot) -> bool| step.operations().any(|operation| touched(operation, wanted));
    let state = (!touches(|slot| matches!(slot, Slot::State(_)))).then_some("c");
    let input = (!touches(|slot| matches!(slot, Slot::Input(_)))).then_some("in");
    state.into_iter().chain(input).collect()
}

/// Declarations of the states with their meanings.
fn state_fields(controller: &Controller) -> Vec<(String, String)> {
    let groups = &controller.programs().states;
    let name =
        |group: &StateGroup| group.length.map_or(group.name.clone(), |n| format!("{}[{n}]", group.name));
    groups.iter().map(|group| (name(group), meaning(group))).collect()
}

/// Statements that put states to their start: a loop for an array that starts with one value.
fn initial(controller: &Controller, precision: Precision, which: OnRestart) -> Vec<String> {
    let programs = controller.programs();
    let groups = programs.states.iter().filter(|group| group.on_restart == which);
    let text = |value: f64| literal(value, precision, Dialect::C);
    groups
        .flat_map(|group| {
            let values: Vec<String> = group.initial.iter().map(|value| text(*value)).collect();
            assignments(programs, group.first, &values)
        })
        .collect()
}

/// Assignments of values to the states from `first`: a loop where they are alike.
pub(crate) fn assignments(programs: &Programs, first: usize, values: &[String]) -> Vec<String> {
    let name = programs.locate(first).map_or("", |(group, _)| group.name.as_str());
    match values {
        [start, rest @ ..] if rest.len() > 1 && rest.iter().all(|value| value == start) => vec![
            format!("for (int i = 0; i < {}; i++) {{", values.len()),
            format!("    c->{name}[i] = {start};"),
            "}".to_owned(),
        ],
        _ => {
            let each = values.iter().enumerate();
            each.map(|(i, value)| format!("{} = {value};", state(programs, first + i, Dialect::C))).collect()
        }
    }
}

fn row(vector: &Vector, controller: &Controller, precision: Precision) -> String {
    let number = |value: f64| literal(value, precision, Dialect::C);
    let taken = vector.readings.iter().take(controller.parts().reading_count());
    let readings: Vec<String> = taken.map(|value| number(*value)).collect();
    let set = vector.set_out_of_balance_kg_m;
    let (sets, value) = (u8::from(set.is_some()), number(set.unwrap_or(0.0)));
    format!("{{ {sets}, {value}, {{ {} }}, {} }}", readings.join(", "), number(vector.control_v))
}
