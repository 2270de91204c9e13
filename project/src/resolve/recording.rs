//! The `[recording]` section: how the columns of recordings become channels.

use counterpoise_models::{AxisKind, FeedbackSignal};
use counterpoise_recordings::{Channel, ChannelSource, ChannelUnits, LoopQuantity, Mapping, Travel};

use super::Project;
use super::controller::RecordingController;
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{Presence, Visit, maybe_number, table};

impl Project {
    /// Returns the unit of what the loop's sensor measures.
    pub fn controlled_unit(&self) -> &'static str {
        self.channel_units().of(Channel::HubRate)
    }

    /// Returns what the axis, the loop's sensor and the recording's controller make of the units of the channels of recordings.
    pub fn channel_units(&self) -> ChannelUnits {
        let reading = match self.plant.sensors.measured {
            FeedbackSignal::HubRate | FeedbackSignal::RelativeRate | FeedbackSignal::MotorRate => {
                LoopQuantity::Rate
            }
            FeedbackSignal::HubPosition | FeedbackSignal::MotorPosition => LoopQuantity::Position,
            FeedbackSignal::Torque => LoopQuantity::Torque,
            FeedbackSignal::Current => LoopQuantity::Current,
        };
        let positioned = matches!(self.recording_controller, Some(RecordingController::Position(_)));
        let demand = if positioned { LoopQuantity::Position } else { reading };
        let travel = match self.plant.axis {
            AxisKind::Rotary => Travel::Turning,
            AxisKind::Linear => Travel::Sliding,
        };
        ChannelUnits { reading, demand, travel }
    }
}

/// Reads or lists the mapping.
pub(crate) fn recording(v: &mut dyn Visit, mapping: &mut Mapping) {
    let period = Field::new(
        "sample_period",
        "sample period of recordings without a time column; other recordings are resampled to it",
    )
    .unit("s")
    .limit(NumberRange::Above(0.0));
    maybe_number(v, &period, &mut mapping.sample_period_s);
    let windows =
        Field::new("windows", "parts that are used, each by its beginning and end after the first sample")
            .unit("s")
            .limit(NumberRange::AtLeast(0.0))
            .or_empty();
    v.pairs(&windows, &mut mapping.windows_s);
    table(v, &TableField::optional("channels", "columns by the channel that they hold"), mapping, channels);
}

fn channels(v: &mut dyn Visit, mapping: &mut Mapping) {
    mapping.time = source(v, "time", mapping.time.take());
    let old = std::mem::take(&mut mapping.channels);
    for channel in Channel::ALL {
        let present = old.iter().find(|(c, _)| *c == channel).map(|(_, s)| s.clone());
        if let Some(source) = source(v, channel.name(), present) {
            mapping.channels.push((channel, source));
        }
    }
}

/// Returns a column's name, or a table with the name, unit, scale and offset.
fn source(v: &mut dyn Visit, channel: &'static str, present: Option<ChannelSource>) -> Option<ChannelSource> {
    let mut column = String::new();
    if v.shorthand(channel, &mut column) {
        return Some(ChannelSource::from_column(&column));
    }
    if !v.enter(&TableField::inline(channel, ""), Presence::from(present.is_some())) {
        return None;
    }
    let mut source = present.unwrap_or_else(|| ChannelSource::from_column(""));
    v.text(&Field::new("column", "name of the column, without its unit"), &mut source.column);
    let mut unit = source.unit.take().unwrap_or_default();
    v.text(
        &Field::new("unit", "unit of the column in place of the one in its header").or_text(""),
        &mut unit,
    );
    source.unit = (!unit.is_empty()).then_some(unit);
    v.number(
        &Field::new("scale", "factor; a negative one turns the sign").limit(NumberRange::Not0).or(1.0),
        &mut source.scale,
    );
    v.number(&Field::new("offset", "added after the factor").or(0.0), &mut source.offset);
    shaping(v, &mut source);
    v.leave();
    Some(source)
}

/// The operations on a column beyond a factor and an offset.
fn shaping(v: &mut dyn Visit, source: &mut ChannelSource) {
    let mut plus = source.plus.take().unwrap_or_default();
    let field = Field::new("plus", "name of another column that is added before the factor").or_text("");
    v.text(&field, &mut plus);
    source.plus = (!plus.is_empty()).then_some(plus);
    let field = Field::new("plus_scale", "factor on the column named by `plus`").or(1.0);
    v.number(&field, &mut source.plus_scale);
    let field = Field::new(
        "wraps_at",
        "number of counts after which the counter starts again at 0: the channel is unwrapped",
    );
    maybe_number(v, &field.limit(NumberRange::Above(0.0)), &mut source.wraps_at);
    let field =
        Field::new("slope_over", "the channel is the slope of the column, as the difference over this time");
    maybe_number(v, &field.unit("s").limit(NumberRange::Above(0.0)), &mut source.slope_over_s);
    let field = Field::new("slope_lag", "the channel is the slope of the column, filtered with this lag");
    maybe_number(v, &field.unit("s").limit(NumberRange::Above(0.0)), &mut source.slope_lag_s);
    let mut clock = source.clock.take().unwrap_or_default();
    let field = Field::new("clock", "column with the times of this column, if it has a clock of its own");
    v.text(&field.or_text(""), &mut clock);
    source.clock = (!clock.is_empty()).then_some(clock);
}
