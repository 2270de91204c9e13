//! A recording is one array, time x channel, whatever is added to it and taken from it.

use counterpoise_recordings::{Channel, Recording};

#[test]
fn channels_keep_their_samples_when_others_come_and_go() {
    let mut recording = Recording::new("run", 1e-3)
        .with(Channel::HubRate, vec![1.0, 2.0, 3.0])
        .with(Channel::Demand, vec![4.0, 5.0, 6.0])
        .with(Channel::Control, vec![7.0, 8.0, 9.0]);
    assert_eq!(recording.remove(Channel::Demand).unwrap().to_vec(), [4.0, 5.0, 6.0]);
    assert_eq!(recording.samples(Channel::Control), Some([7.0, 8.0, 9.0].as_slice()));
    assert_eq!(recording.set(Channel::HubRate, vec![0.0; 3]).unwrap().to_vec(), [1.0, 2.0, 3.0]);
    recording.samples_mut(Channel::HubRate).unwrap()[1] = -1.0;
    assert_eq!(recording.part(1..5).samples(Channel::HubRate), Some([-1.0, 0.0].as_slice()));
    assert_eq!((recording.len(), recording.channels().count()), (3, 2));
    // the order in which channels were added does not count
    let other = Recording::new("run", 1e-3)
        .with(Channel::Control, vec![7.0, 8.0, 9.0])
        .with(Channel::HubRate, vec![0.0, -1.0, 0.0]);
    assert_eq!(recording, other);
}

#[test]
fn a_shorter_channel_ends_without_samples() {
    let recording = Recording::new("run", 1e-3)
        .with(Channel::Control, vec![1.0])
        .with(Channel::HubRate, vec![1.0, 2.0, 3.0]);
    let control = recording.samples(Channel::Control).unwrap();
    assert!(control.len() == 3 && control[0] == 1.0 && control[1..].iter().all(|v| v.is_nan()));
    let mut alone = recording;
    alone.remove(Channel::HubRate);
    alone.set(Channel::Control, vec![2.0, 3.0]);
    assert_eq!(alone.samples(Channel::Control), Some([2.0, 3.0].as_slice()));
}
