//! Recordings beside the workspace, read for tests.

use counterpoise_controller::ProportionalIntegral;
use counterpoise_simulate::Recording;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use std::path::PathBuf;

/// A file beside the workspace.
pub fn shared(path: &str) -> Option<PathBuf> {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(path);
    if file.exists() {
        return Some(file);
    }
    panic!("{} is absent", file.display());
}

/// A practice recording.
pub fn recording(path: &str) -> Option<Recording> {
    let file = std::fs::File::open(shared(&format!("practice/{path}.parquet"))?).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let mut columns = vec![Vec::new(); schema.num_columns()];
    for row in reader.get_row_iter(None).unwrap() {
        let row = row.unwrap();
        for (k, column) in columns.iter_mut().enumerate() {
            column.push(row.get_double(k).or_else(|_| row.get_float(k).map(f64::from)).unwrap());
        }
    }
    let find = |name: &str| {
        let index = (0..schema.num_columns()).find(|&k| schema.column(k).name().starts_with(name))?;
        Some(columns[index].clone())
    };
    Some(Recording {
        name: path.to_owned(),
        sample_period_s: 1e-3,
        demand_rad_s: find("demand"),
        control_v: find("control"),
        hub_rate_rad_s: find("hub_rate"),
        platform_rate_rad_s: find("platform_rate"),
        platform_accel_m_s2: find("platform_accel"),
        motor_rate_rad_s: find("motor_rate"),
        hub_position_rad: find("hub_position"),
    })
}

/// The controller that was in the loop when the practice recordings were made.
pub fn controller() -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: 18.0,
        ki_v_rad: 80.0,
        bias_v: 2.88,
        sample_period_s: 1e-3,
        integral_v: 0.0,
    }
}
