//! The fixed-point controller in C99.

use counterpoise_controller::READING_NAMES;
use counterpoise_controller::program::{OnRestart, Program, Slot};
use minijinja::{Environment, context};

use crate::c99::{assignments, line_with, with_guard};
use crate::comment::comment_text;
use crate::fixed_point::format::{to_integer, unit};
use crate::fixed_point::guard::{FixedSettings, SHARE_BITS};
use crate::fixed_point::{FULL, FixedOperation, FixedPointController, FixedProgram, FixedRunner, FixedTerm};
use crate::guard::{flags, guard_bytes, mark_files};
use crate::print::{Dialect, limit, meaning, state, wrap};
use crate::vectors::{SHIPPED_SAMPLES, self_test_vectors};
use crate::{Error, ExportSource, File, Provenance, Ranges, check_name, reading_fields};

/// Returns the controller in C99 with 32-bit integers: the files and functions of [`crate::c99()`]. The header states the format of each reading and
/// of the control.
///
/// # Errors
/// [`Error::Name`], and [`Error::OtherController`] if the plan was made for another controller than the source.
pub fn fixed_c99<'a>(
    source: impl Into<ExportSource<'a>>,
    fixed: &FixedPointController,
    provenance: &Provenance,
    name: &str,
) -> Result<Vec<File>, Error> {
    let source = source.into();
    check_name(name)?;
    if *source.controller() != fixed.controller {
        return Err(Error::OtherController);
    }
    let board = provenance.converters.fixed_block(fixed);
    let data = context! { board, ..data(fixed, &provenance.header(source), name) };
    let environment = Environment::new();
    let data = with_guard(&environment, data)?;
    let templates = [
        (".h", include_str!("../../templates/fixed.h.jinja")),
        (".c", include_str!("../../templates/fixed.c.jinja")),
        ("_self_test.c", include_str!("../../templates/fixed_self_test.c.jinja")),
        ("_test.c", include_str!("../../templates/fixed_test.c.jinja")),
        ("_interrupt.c", include_str!("../../templates/fixed_interrupt.c.jinja")),
        ("_README.md", include_str!("../../templates/fixed_readme.md.jinja")),
    ];
    let fill = |(ending, template): (&str, &str)| {
        let text = environment.render_str(template, &data)?.trim_end().to_owned() + "\n";
        Ok(File { name: format!("{name}{ending}"), text })
    };
    Ok(mark_files(templates.into_iter().map(fill).collect::<Result<_, Error>>()?))
}

fn data(fixed: &FixedPointController, provenance: &[String], name: &str) -> minijinja::Value {
    let programs = fixed.controller.programs();
    let guard = FixedSettings::of(fixed);
    let readings: Vec<(&str, i32, &str, String)> = reading_fields(&fixed.controller)
        .iter()
        .zip(&fixed.step.inputs)
        .map(|(field, bits)| (field.0, *bits, field.1, full_scale(*bits)))
        .collect();
    let fields: Vec<String> = programs
        .states
        .iter()
        .map(|group| {
            let array = group.length.map_or(String::new(), |n| format!("[{n}]"));
            let bits = formats(&fixed.states[group.first..][..group.initial.len()]);
            format!("{}{array}; /* Q {bits}: {} */", group.name, meaning(group))
        })
        .collect();
    let printer = |program, fixed_program, input| Printer { fixed, name, program, fixed_program, input };
    context! {
        name, NAME => name.to_uppercase(),
        provenance => provenance.to_vec(),
        verified => line_with(provenance, "verified:"),
        hash => line_with(provenance, "project-hash:"),
        readings,
        fields,
        control_bits => fixed.control_bits(),
        control_full => full_scale(fixed.control_bits()),
        set_full => full_scale(fixed.set_out_of_balance.inputs[0]),
        limit => format!("{:?}", fixed.controller.limit_v()),
        state_bytes => 4 * programs.state_count() + guard_bytes(&fixed.controller, 4),
        flags => flags(&fixed.controller),
        guard => context! {
            limits => guard.limits[..fixed.step.inputs.len()].to_vec(), share_step => guard.share_step, share_bits => SHARE_BITS,
            whole => 1 << SHARE_BITS,
        },
        set_bits => fixed.set_out_of_balance.inputs[0],
        rate_hz => (1.0 / fixed.controller.sample_period_s()).round() as u64,
        period => format!("{:?}", fixed.controller.sample_period_s()),
        worst => format!("{:.2e}", fixed.deviation.worst_v),
        likely => format!("{:.2e}", fixed.deviation.likely_v),
        rms => format!("{:.2e}", fixed.deviation.rms_v),
        samples => fixed.deviation.samples,
        keep => initial(fixed, OnRestart::Keep),
        restart => initial(fixed, OnRestart::Restart),
        step => printer(&programs.step, &fixed.step, "in->").body(),
        set => printer(&programs.set_out_of_balance, &fixed.set_out_of_balance, "").body(),
        vectors => rows(fixed),
    }
}

/// Returns the largest magnitude of a format.
fn full_scale(bits: i32) -> String {
    format!("{:.4}", FULL as f64 * unit(bits)).trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn formats(bits: &[i32]) -> String {
    bits.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

fn initial(fixed: &FixedPointController, which: OnRestart) -> Vec<String> {
    let programs = fixed.controller.programs();
    let groups = programs.states.iter().filter(|group| group.on_restart == which);
    groups
        .flat_map(|group| {
            let values = &fixed.initial[group.first..group.first + group.initial.len()];
            assignments(programs, group.first, &values.iter().map(ToString::to_string).collect::<Vec<_>>())
        })
        .collect()
}

fn rows(fixed: &FixedPointController) -> Vec<String> {
    let mut runner = FixedRunner::new(fixed);
    let row = |vector: &crate::vectors::Vector| {
        let set =
            vector.set_out_of_balance_kg_m.map(|set| to_integer(set, fixed.set_out_of_balance.inputs[0]));
        if let Some(set) = set {
            runner.set_integer(set);
        }
        let readings = fixed.step.integers(&vector.readings);
        let control = runner.step_integers(&readings);
        let list: Vec<String> =
            readings.iter().take(fixed.step.inputs.len()).map(ToString::to_string).collect();
        format!(
            "{{ {}, {}, {{ {} }}, {control} }}",
            u8::from(set.is_some()),
            set.unwrap_or(0),
            list.join(", ")
        )
    };
    self_test_vectors::<f64>(&fixed.controller, SHIPPED_SAMPLES).iter().map(row).collect()
}

struct Printer<'a> {
    fixed: &'a FixedPointController,
    name: &'a str,
    program: &'a Program,
    fixed_program: &'a FixedProgram,
    input: &'a str,
}

impl Printer<'_> {
    fn body(&self) -> String {
        let mut text = String::new();
        let mut operations = self.fixed_program.operations.iter();
        for section in &self.program.sections {
            text.push_str(&format!("    /* {} */\n", comment_text(&section.says)));
            for _ in &section.operations {
                text.push_str(
                    &operations.next().map_or(String::new(), |operation| self.statement(operation)),
                );
            }
            text.push('\n');
        }
        match self.program.output {
            Some(output) => text + &format!("    return {};\n", self.slot(output)),
            None => text.trim_end().to_owned() + "\n",
        }
    }

    fn slot(&self, slot: Slot) -> String {
        let programs = self.fixed.controller.programs();
        match slot {
            Slot::Input(i) if self.input.is_empty() => self.program.inputs[i].clone(),
            Slot::Input(i) => format!("{}{}", self.input, READING_NAMES[i]),
            Slot::Local(_) => Ranges::name(&self.fixed.controller, self.program, slot),
            Slot::State(i) => state(programs, i, Dialect::C),
        }
    }

    fn statement(&self, operation: &FixedOperation) -> String {
        let (into, pieces) = self.pieces(operation);
        let head = match into {
            Slot::Local(i) => {
                let bits = self.fixed_program.locals[i];
                format!("    const int32_t {} /* Q {bits} */ = ", self.slot(into))
            }
            _ => format!("    {} = ", self.slot(into)),
        };
        wrap(&head, &pieces, "        ")
    }

    fn pieces(&self, operation: &FixedOperation) -> (Slot, Vec<String>) {
        let name = self.name;
        let wide = |slot: &Slot| format!("(int64_t){}", self.slot(*slot));
        match operation {
            FixedOperation::Sum { into, constant, terms, shift } => {
                (*into, self.sum(*constant, terms, *shift))
            }
            FixedOperation::Product { into, a, b, shift } => {
                (*into, vec![format!("{name}_narrow({} * {}, {shift}U)", wide(a), wide(b))])
            }
            FixedOperation::Quotient { into, above, below, left, shift } => {
                let scale = 1_i64 << left;
                let quotient = format!("({} * INT64_C({scale})) / {}", wide(above), wide(below));
                (*into, vec![format!("{name}_narrow({quotient}, {shift}U)")])
            }
            FixedOperation::Magnitude { into, of } => {
                let of = self.slot(*of);
                (*into, vec![format!("(({of} < 0) ? -{of} : {of})")])
            }
            FixedOperation::Clamp { into, of, low, high } => {
                let of = self.slot(*of);
                (*into, limit(&of, &low.to_string(), &high.to_string()))
            }
        }
    }

    fn sum(&self, constant: i64, terms: &[FixedTerm], shift: u32) -> Vec<String> {
        if let ([FixedTerm { factor: 1, of }], 0, 0) = (terms, constant, shift) {
            return vec![self.slot(*of)];
        }
        let mut pieces = vec![format!("{}_narrow(", self.name)];
        if constant != 0 || terms.is_empty() {
            pieces.push(format!("INT64_C({constant})"));
        }
        for FixedTerm { factor, of } in terms {
            let (before, sign) = match (pieces.len() > 1, *factor < 0) {
                (true, true) => ("- ", ""),
                (true, false) => ("+ ", ""),
                (false, true) => ("", "-"),
                (false, false) => ("", ""),
            };
            pieces.push(format!("{before}({sign}INT64_C({}) * {})", factor.abs(), self.slot(*of)));
        }
        if let Some(last) = pieces.last_mut() {
            last.push_str(&format!(", {shift}U)"));
        }
        pieces
    }
}
