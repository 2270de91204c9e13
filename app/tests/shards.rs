//! The files of a campaign's shards: what is written is read again, and a file of which any single bit is changed is refused.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;

use counterpoise_host::projects::{self, ProjectWorld};
use counterpoise_host::shards;
use counterpoise_host::stages::ProgressDisplay;
use counterpoise_pipeline as pipeline;
use counterpoise_project::Purpose;
use counterpoise_report::wording::code_header::HeaderText;

use crate::support;

use support::{CAMPAIGN, folder_with};

#[test]
fn every_single_bit_error_of_a_shard_is_refused() {
    let folder = folder_with("shard_bits", CAMPAIGN);
    let loaded = projects::load_project(&folder, Purpose::Sweep).unwrap();
    let world = ProjectWorld::of(&loaded, ProgressDisplay::Quiet);
    let designed =
        pipeline::design_project(&loaded.project, &pipeline::DesignContents::default(), &HeaderText, &world)
            .unwrap();
    let campaign = pipeline::prepare_campaign(
        &loaded.project,
        &designed.stages.modelled,
        &designed.stages.verified,
        &world,
    )
    .unwrap();
    let samples: Vec<_> = (0..campaign.len()).map(|k| campaign.run(k).unwrap()).collect();
    let path = shards::shard_path(&folder, 0, 1);
    shards::write_shard(&path, &campaign, "a campaign", &samples).unwrap();
    assert_eq!(shards::read_shard(&path, &campaign, "a campaign").unwrap(), samples);
    assert!(shards::read_shard(&path, &campaign, "another").is_err());
    // The decoder may panic on a damaged file; that is caught, and need not be printed.
    std::panic::set_hook(Box::new(|_| {}));
    let sound = fs::read(&path).unwrap();
    let mut accepted = Vec::new();
    for bit in 0..8 * sound.len() {
        let mut damaged = sound.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        fs::write(&path, &damaged).unwrap();
        if shards::read_shard(&path, &campaign, "a campaign").is_ok() {
            accepted.push(bit);
        }
    }
    for length in 0..sound.len() {
        fs::write(&path, &sound[..length]).unwrap();
        if shards::read_shard(&path, &campaign, "a campaign").is_ok() {
            accepted.push(length);
        }
    }
    let _ = std::panic::take_hook();
    assert!(accepted.is_empty(), "{accepted:?}");
    println!("{} single-bit errors and {} cut files, none accepted", 8 * sound.len(), sound.len());
}
