//! Remarks about the file of a recording, in sentences.

use counterpoise_recordings::{DoubtfulUnit, Remark};

/// Describes what the user of a recording should know about its file.
pub fn describe_file_remark(remark: &Remark) -> String {
    match remark {
        Remark::PeriodAssumed { period_s } => {
            format!("no time column: the project's sample period of {period_s} s was taken")
        }
        Remark::Repeated { rows, first_row } => {
            format!("{rows} rows repeat the row before them, the first in row {first_row}: they count once")
        }
        Remark::Uneven { jitter, period_s } => {
            format!("time steps vary by {:.2} %: interpolated every {period_s:.6} s", 100.0 * jitter)
        }
        Remark::Gap { row, samples } => format!("{samples} samples are missing after row {row}"),
        Remark::Missing { channel, samples, first_row } => {
            format!("{}: {samples} values are missing, the first in row {first_row}", channel.name())
        }
        Remark::Unread { column, why } => {
            format!("column \"{column}\" was not read: {why}")
        }
        Remark::NearlyNamed { column, meant } => format!(
            "column \"{column}\" is not used: if it is {meant}, name it so, or map {meant} to it in the project file"
        ),
        Remark::Infinite { channel, samples, first_row } => format!(
            "{}: {samples} values are infinite, the first in row {first_row}: they count as missing",
            channel.name()
        ),
        Remark::Outliers { channel, samples, first_row, value } => format!(
            "{}: {samples} reading{} far from those before and after, the first in row {first_row} ({value} {}): \
                 {} as missing; check the recorder",
            channel.name(),
            if *samples == 1 { " is" } else { "s are" },
            channel.unit(),
            if *samples == 1 { "it counts" } else { "they count" }
        ),
        Remark::Further { columns } => {
            format!("{columns} further columns were not read or are not used")
        }
        Remark::Resampled { file_s, project_s, doubt } => {
            let how = if file_s < project_s { "averaged" } else { "interpolated" };
            let done = format!("sampled every {file_s} s: {how} to the project's {project_s} s");
            match doubt {
                Some(DoubtfulUnit { meant: Some(unit) }) => format!("{done}; is its time in {unit}?"),
                Some(DoubtfulUnit { meant: None }) => format!("{done}; check the unit of its time"),
                None => done,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_say_what_to_do() {
        let column = || "Hub_Position".to_owned();
        let why = counterpoise_recordings::UnreadReason::Shape { shape: vec![40, 2, 2] };
        let unread = describe_file_remark(&Remark::Unread { column: column(), why });
        assert_eq!(
            unread,
            "column \"Hub_Position\" was not read: its shape is 40 x 2 x 2, but a column or a matrix of columns is needed"
        );
        let near = describe_file_remark(&Remark::NearlyNamed { column: column(), meant: "hub_position" });
        assert!(near.ends_with("name it so, or map hub_position to it in the project file"), "{near}");
        let doubt = Some(DoubtfulUnit { meant: Some("ms") });
        let slow = describe_file_remark(&Remark::Resampled { file_s: 1.0, project_s: 1e-3, doubt });
        assert!(slow.ends_with("interpolated to the project's 0.001 s; is its time in ms?"), "{slow}");
    }
}
