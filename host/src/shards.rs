//! The samples of a campaign in Parquet files, one a shard, written whole or not at all.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, anyhow, bail, ensure};
use bytes::Bytes;
use counterpoise_verify::robustness::{Campaign, Sample};
use parquet::basic::Compression;
use parquet::data_type::{DoubleType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::RowAccessor;
use parquet::schema::parser::parse_message_type;
use sha2::{Digest, Sha256};

use crate::files;
use crate::projects::write_file;

/// Key under which a file names its campaign.
const CAMPAIGN: &str = "counterpoise.campaign";

/// Key under which a file keeps the SHA-256 of what it holds.
const CHECKSUM: &str = "counterpoise.sha256";

/// Returns the file of a shard, counted from 0.
pub fn shard_path(folder: &Path, shard: usize, shards: usize) -> PathBuf {
    folder.join(format!("shard-{shard:06}-of-{shards:06}.parquet"))
}

/// Writes samples under the campaign's name. The same samples give the same bytes.
pub fn write_shard(path: &Path, campaign: &Campaign, name: &str, samples: &[Sample]) -> Result<()> {
    let told = || format!("cannot make {}", path.display());
    write_file(path, &bytes(campaign, name, samples).with_context(told)?)
}

fn bytes(campaign: &Campaign, name: &str, samples: &[Sample]) -> Result<Vec<u8>> {
    let schema = Arc::new(parse_message_type(&schema(campaign))?);
    let metadata = vec![
        KeyValue::new(CAMPAIGN.to_owned(), name.to_owned()),
        KeyValue::new(CHECKSUM.to_owned(), checksum(name, samples)),
    ];
    let properties = WriterProperties::builder()
        .set_compression(Compression::UNCOMPRESSED)
        .set_created_by("counterpoise".to_owned())
        .set_key_value_metadata(Some(metadata));
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties.build()))?;
    let mut group = writer.next_row_group()?;
    let mut at = 0;
    while let Some(mut column) = group.next_column()? {
        if at == 0 {
            let numbers: Vec<i64> = samples.iter().map(|sample| sample.index as i64).collect();
            column.typed::<Int64Type>().write_batch(&numbers, None, None)?;
        } else {
            let values: Vec<f64> = samples.iter().map(|sample| number(sample, at - 1)).collect();
            column.typed::<DoubleType>().write_batch(&values, None, None)?;
        }
        column.close()?;
        at += 1;
    }
    group.close()?;
    Ok(writer.into_inner()?)
}

/// SHA-256 of the campaign's name and of every number, as bits.
fn checksum(name: &str, samples: &[Sample]) -> String {
    let mut digest = Sha256::new_with_prefix(name.as_bytes());
    for sample in samples {
        digest.update((sample.index as u64).to_le_bytes());
        for value in sample.factors.iter().chain(&sample.values) {
            digest.update(value.to_bits().to_le_bytes());
        }
    }
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Factors first, then figures.
fn number(sample: &Sample, at: usize) -> f64 {
    let factors = sample.factors.len();
    if at < factors { sample.factors[at] } else { sample.values[at - factors] }
}

fn schema(campaign: &Campaign) -> String {
    let factors =
        campaign.variations().iter().map(|variation| format!("factor_{}", variation.parameter.key()));
    let figures = campaign.requirements().iter().map(|requirement| word(&requirement.figure.key()));
    let columns = factors.chain(figures).enumerate().map(|(k, name)| format!("required double {name}_{k};"));
    format!("message campaign {{ required int64 sample; {} }}", columns.collect::<Vec<_>>().join(" "))
}

/// Returns a key as one word.
fn word(key: &str) -> String {
    key.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect()
}

/// Reads samples, refusing a file of another campaign and one of which any bit was changed.
pub fn read_shard(path: &Path, campaign: &Campaign, name: &str) -> Result<Vec<Sample>> {
    let damaged =
        || format!("cannot read {}: it may be damaged; remove it and run its shard again", path.display());
    let bytes = files::read_file(path).with_context(damaged)?;
    // The decoder is made for sound files: on a damaged one it must not end the program.
    let quiet = || decode_shard(path, &bytes, campaign, name);
    let samples =
        std::panic::catch_unwind(std::panic::AssertUnwindSafe(quiet)).map_err(|_| anyhow!(damaged()))??;
    // The same samples give the same bytes, so a file that is not what its samples give was changed.
    ensure!(self::bytes(campaign, name, &samples).with_context(damaged)? == bytes, damaged());
    Ok(samples)
}

fn decode_shard(path: &Path, bytes: &[u8], campaign: &Campaign, name: &str) -> Result<Vec<Sample>> {
    let told =
        || format!("cannot read {}: it may be damaged; remove it and run its shard again", path.display());
    let reader = SerializedFileReader::new(Bytes::copy_from_slice(bytes)).with_context(told)?;
    let written = reader.metadata().file_metadata().key_value_metadata();
    let under = |key: &str| {
        written.and_then(|all| all.iter().find(|pair| pair.key == key)).and_then(|pair| pair.value.clone())
    };
    let promised = under(CHECKSUM);
    match under(CAMPAIGN) {
        Some(found) if found == name => {}
        found => bail!(
            "{} belongs to another campaign ({}, not {name}): another project, version, seed or number of samples",
            path.display(),
            found.unwrap_or_else(|| "unnamed".to_owned())
        ),
    }
    let factors = campaign.variations().len();
    let columns = factors + campaign.requirements().len();
    let found = reader.metadata().file_metadata().schema_descr().num_columns();
    ensure!(found == columns + 1, "{} has {found} columns where {} are needed", path.display(), columns + 1);
    let mut samples = Vec::new();
    for row in reader.get_row_iter(None).with_context(told)? {
        let row = row.with_context(told)?;
        let mut numbers =
            (1..=columns).map(|k| row.get_double(k)).collect::<Result<Vec<f64>, _>>().with_context(told)?;
        let values = numbers.split_off(factors);
        samples.push(Sample {
            index: row.get_long(0).with_context(told)? as usize,
            factors: numbers,
            values,
        });
    }
    ensure!(promised.is_some_and(|promised| promised == checksum(name, &samples)), told());
    Ok(samples)
}

/// Returns the files of shards in a folder, sorted.
pub fn shard_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let told = || format!("cannot list {}", folder.display());
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(told)? {
        let path = entry.with_context(told)?.path();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if name.starts_with("shard-") && name.ends_with(".parquet") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}
