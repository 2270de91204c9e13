//! A unit's files as one archive.

use crate::File;

/// Returns the `.fmu` archive of a unit: a zip whose files are stored, without times, so that the same unit gives
/// the same bytes. `files` are those of [`super::controller_unit`] or [`super::plant_unit`]; their common folder is
/// left out. A library compiled for 64-bit Linux may be added: then importers need no compiler.
pub fn pack_unit(files: &[File], name: &str, linux_library: Option<&[u8]>) -> Vec<u8> {
    let folder = format!("{name}/");
    let inside = |file: &File| file.name.strip_prefix(&folder).unwrap_or(&file.name).to_owned();
    let mut entries: Vec<(String, &[u8])> =
        files.iter().map(|file| (inside(file), file.text.as_bytes())).collect();
    entries.extend(linux_library.map(|library| (format!("binaries/x86_64-linux/{name}.so"), library)));
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (path, content) in &entries {
        let header = header(path, content);
        directory.extend(b"PK\x01\x02\x14\x03");
        directory.extend(&header);
        directory.extend([0; 6]);
        directory.extend([0, 0, 0xa4, 0x81]);
        put(&mut directory, archive.len());
        directory.extend(path.as_bytes());
        archive.extend(b"PK\x03\x04");
        archive.extend(&header);
        archive.extend(path.as_bytes());
        archive.extend(*content);
    }
    let start = archive.len();
    archive.extend(&directory);
    archive.extend(b"PK\x05\x06\0\0\0\0");
    let count = (entries.len() as u16).to_le_bytes();
    archive.extend(count);
    archive.extend(count);
    put(&mut archive, directory.len());
    put(&mut archive, start);
    archive.extend([0, 0]);
    archive
}

/// Returns what a local and a central header share: version, flags, method, time (1980-01-01), checksum, sizes,
/// lengths.
fn header(path: &str, content: &[u8]) -> Vec<u8> {
    let mut bytes = vec![20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0];
    bytes.extend(crc32(content).to_le_bytes());
    put(&mut bytes, content.len());
    put(&mut bytes, content.len());
    bytes.extend((path.len() as u16).to_le_bytes());
    bytes.extend([0, 0]);
    bytes
}

fn put(bytes: &mut Vec<u8>, size: usize) {
    bytes.extend((size as u32).to_le_bytes());
}

/// Returns the checksum of zip archives: CRC-32 with the reflected polynomial 0xEDB88320.
fn crc32(content: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
    };
    !content.iter().fold(!0, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_the_published_one() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn the_same_files_give_the_same_bytes() {
        let files = [File { name: "axis/modelDescription.xml".into(), text: "<x/>".into() }];
        let archive = pack_unit(&files, "axis", Some(&[1, 2, 3]));
        assert_eq!(archive, pack_unit(&files, "axis", Some(&[1, 2, 3])));
        let text = String::from_utf8_lossy(&archive);
        assert!(
            text.contains("PK")
                && text.contains("binaries/x86_64-linux/axis.so")
                && !text.contains("axis/model")
        );
    }
}
