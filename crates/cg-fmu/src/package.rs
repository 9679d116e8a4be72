//! The file `.fmu`: a zip archive with model description, shared libraries and resources.

use std::io::{Cursor, Write};

use object::{Architecture, BinaryFormat, Object};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::error::FmuError;
use crate::fmu::{CALIBRATION, Fmu, VEHICLE};

/// A function that only the shared library of FMI has.
const STEP: &[u8] = b"fmi3DoStep";

/// A shared library and its platform.
pub struct Binary {
    platform: String,
    suffix: &'static str,
    bytes: Vec<u8>,
}

impl Binary {
    /// A library, whose platform follows from its bytes. `name` is its name in messages.
    ///
    /// # Errors
    /// [`FmuError`] if it is not a shared library of FMI for a known platform.
    pub fn new(name: &str, bytes: Vec<u8>) -> Result<Self, FmuError> {
        let refuse = |what: &str| {
            FmuError::new(format!(
                "{name}: {what}; give the library that cargo build --package cg-fmi makes"
            ))
        };
        let file = object::File::parse(&*bytes).map_err(|_| refuse("not a shared library"))?;
        let machine = match file.architecture() {
            Architecture::X86_64 => "x86_64",
            Architecture::Aarch64 => "aarch64",
            Architecture::I386 => "x86",
            _ => return Err(refuse("a library for an unknown processor")),
        };
        let (system, suffix) = match file.format() {
            BinaryFormat::Elf => ("linux", "so"),
            BinaryFormat::Pe => ("windows", "dll"),
            BinaryFormat::MachO => ("darwin", "dylib"),
            _ => return Err(refuse("a library for an unknown system")),
        };
        // Names on macOS begin with an underscore.
        let exports = file.exports().map_err(|_| refuse("a damaged library"))?;
        if !exports.iter().any(|export| export.name().ends_with(STEP)) {
            return Err(refuse("not a library with the functions of FMI 3.0"));
        }
        Ok(Self { platform: format!("{machine}-{system}"), suffix, bytes })
    }

    /// The platform as FMI names it, such as `x86_64-linux`.
    pub fn platform(&self) -> &str {
        &self.platform
    }
}

/// The bytes of the file. The model description comes first and is not compressed, so that cg knows its
/// own files. Equal inputs give equal bytes.
///
/// # Errors
/// [`FmuError`] if there is no library, or two for one platform.
pub fn package(fmu: &Fmu, binaries: &[Binary]) -> Result<Vec<u8>, FmuError> {
    for (place, binary) in binaries.iter().enumerate() {
        if binaries[..place].iter().any(|other| other.platform == binary.platform) {
            return Err(FmuError::new(format!(
                "two libraries for {}: give one for each platform",
                binary.platform
            )));
        }
    }
    if binaries.is_empty() {
        return Err(FmuError::new("an FMU needs at least one shared library"));
    }
    archive(fmu, binaries).map_err(|error| FmuError::new(format!("the archive: {error}")))
}

fn archive(fmu: &Fmu, binaries: &[Binary]) -> zip::result::ZipResult<Vec<u8>> {
    let plain = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    let packed = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("modelDescription.xml", plain)?;
    zip.write_all(&fmu.description()?)?;
    let model = fmu.kind().model_identifier();
    for Binary { platform, suffix, bytes } in binaries {
        let name = format!("binaries/{platform}/{model}.{suffix}");
        zip.start_file(name, packed.unix_permissions(0o755))?;
        zip.write_all(bytes)?;
    }
    let files = fmu.files();
    let calibration = files.calibration.as_ref().map(|text| (CALIBRATION, text));
    for (name, text) in [(VEHICLE, &files.vehicle)].into_iter().chain(calibration) {
        zip.start_file(format!("resources/{name}"), packed)?;
        zip.write_all(text.as_bytes())?;
    }
    Ok(zip.finish()?.into_inner())
}
