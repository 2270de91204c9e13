//! The second cursor: a place from which differences are measured. Charts of a group share it, as they share the cursor under the pointer.

use egui::{Context, Id};

use super::chart::Chart;

/// Returns where the second cursor stands, on the x axis; `None` if it is not set.
pub fn second_cursor(context: &Context, chart: &Chart) -> Option<f64> {
    context.data(|data| data.get_temp::<f64>(id(chart)))
}

/// Sets the second cursor, or takes it away if it is there.
pub fn toggle_second_cursor(context: &Context, chart: &Chart, x: f64) {
    context.data_mut(|data| {
        if data.remove_temp::<f64>(id(chart)).is_none() {
            data.insert_temp(id(chart), x);
        }
    });
    context.request_repaint();
}

fn id(chart: &Chart) -> Id {
    Id::unique(("second cursor", chart.group.unwrap_or(chart.title.as_str())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charts_of_a_group_share_it_and_a_second_call_takes_it_away() {
        let context = Context::default();
        let chart = |title: &str| Chart::new(title, "time, s", "rate");
        let (a, b) = (chart("a").with_group("runs"), chart("b").with_group("runs"));
        toggle_second_cursor(&context, &a, 1.5);
        assert_eq!((second_cursor(&context, &b), second_cursor(&context, &chart("a"))), (Some(1.5), None));
        toggle_second_cursor(&context, &b, 2.0);
        assert_eq!(second_cursor(&context, &a), None);
    }
}
