//! The state file, which keeps the estimator's memory over restarts. Its text is that of
//! [`cg_logs::state`].
//!
//! The file is written completely or not at all, and is checked when it is read. A file that is
//! damaged or belongs to another version or vehicle is renamed and never overwritten, so that it
//! can be examined. So is a file that another program has written in the meantime.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use cg_core::Memory;
use cg_logs::estimate::{Gusts, Strength};
use cg_logs::learn::Learned;
use cg_logs::state::{Owner, State, StateError};
use cg_output::{Draft, Target};
use cg_vehicle::files::checksum;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::scales::Scale;

/// Maximum size of a state file, bytes.
const LONGEST: u64 = 1 << 20;

/// The state file.
#[derive(Debug)]
pub(crate) struct StateFile {
    target: Target,
    owner: Owner,
    /// Checksum of the file as this process has first read or last written it; that of no bytes if
    /// there was none.
    known_crc32: Option<u32>,
    /// The new path of another program's state that was renamed and is not reported yet.
    pub(crate) aside: Option<PathBuf>,
    /// That of the last one. What the same program writes later replaces it, so that two programs do not fill a disk.
    last_aside: Option<PathBuf>,
}

/// What is kept of the present load beside the estimator's memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct SavedLoad {
    /// Time of the last change of the load, s.
    pub(crate) since_s: Option<f64>,
    /// The scale of its mass.
    pub(crate) scale: Option<Scale>,
    /// Standard deviation of its mass, kg, if it was given.
    pub(crate) mass_sd_kg: Option<f64>,
    /// Whether that mass is of the load before.
    pub(crate) mass_is_of_another_load: bool,
    /// Whether turns said that the height is of another load.
    pub(crate) height_is_doubted: bool,
    /// Where the lift axles were.
    pub(crate) lift_axle: LiftAxle,
    /// What its turns came to.
    pub(crate) strength: Strength,
    /// What a wind makes of their ratios.
    pub(crate) gusts: Gusts,
    /// The bank that the heights assume, rad.
    pub(crate) bank_sds_rad: Option<[f64; 2]>,
    /// Standard deviation of the height by turns that were left out and by the sensors of the roll angle, m.
    pub(crate) beside_sd_m: f64,
    /// The part of the load that came or went, kg.
    pub(crate) part_kg: f64,
    /// Number of learned trips in the design, and the time of the newest, s.
    pub(crate) trips_in_use: (usize, Option<f64>),
    /// What is wrong with a signal.
    pub(crate) wrong_signal: Option<String>,
}

/// The content of a state file.
#[derive(Debug, PartialEq)]
pub(crate) enum Found {
    /// There is no state yet.
    Nothing,
    /// A valid state.
    State(Box<State>),
    /// Another content. The file was renamed to this path, for this reason.
    PutAside(PathBuf, StateError),
}

impl StateFile {
    pub(crate) const fn new(target: Target, owner: Owner) -> Self {
        Self { target, owner, known_crc32: None, aside: None, last_aside: None }
    }

    /// Writes a state; it replaces the previous one of this process.
    pub(crate) fn save(
        &mut self,
        memory: &Memory<f64>,
        saved_s: f64,
        load: SavedLoad,
        learned: Learned,
    ) -> io::Result<()> {
        let mut state = State::new(self.owner.clone(), memory, saved_s, load.since_s, learned);
        (state.scale, state.mass_sd_kg) = (load.scale, load.mass_sd_kg);
        state.wrong_signal = load.wrong_signal;
        state.mass_is_of_another_load = load.mass_is_of_another_load;
        state.height_is_doubted = load.height_is_doubted;
        state.lift_axle = load.lift_axle;
        state.strength = load.strength;
        state.gusts = load.gusts;
        (state.bank_sds_rad, state.beside_sd_m) = (load.bank_sds_rad, load.beside_sd_m);
        state.part_kg = load.part_kg;
        state.trips_in_use = Some(load.trips_in_use.0);
        state.newest_in_use_s = load.trips_in_use.1;
        let text = state.to_text()?;
        let (draft, mut file) = self.target.open()?;
        file.write_all(text.as_bytes())?;
        self.keep_others()?;
        draft.map_or(Ok(()), Draft::publish)?;
        self.known_crc32 = Some(crc32(text.as_bytes()));
        self.store_name()
    }

    pub(crate) fn path(&self) -> &Path {
        self.target.path()
    }

    /// Whether the file could be written; it remains as it is.
    pub(crate) fn try_open(&self) -> io::Result<()> {
        // A draft that is not published is removed.
        self.target.open().map(drop)
    }

    /// Renames a state that another program has written since this one has read or written the file.
    fn keep_others(&mut self) -> io::Result<()> {
        let present = self.bytes()?.unwrap_or_default();
        if !present.is_empty() && self.known_crc32 != Some(crc32(&present)) {
            let aside = match self.last_aside.take() {
                None => self.put_aside()?,
                Some(aside) => fs::rename(self.itself(), &aside).map(|()| aside)?,
            };
            self.last_aside = Some(aside.clone());
            self.aside = Some(aside);
        }
        Ok(())
    }

    /// The path of the file itself if the given path is a link.
    fn itself(&self) -> PathBuf {
        let path = self.target.path();
        let is_link = fs::symlink_metadata(path).is_ok_and(|about| about.is_symlink());
        let itself = is_link.then(|| fs::canonicalize(path).ok()).flatten();
        itself.unwrap_or_else(|| path.to_owned())
    }

    /// The new name is on the disk only after its folder is written. Windows does not open folders
    /// as files, and its file system keeps a journal of names.
    fn store_name(&self) -> io::Result<()> {
        if cfg!(windows) {
            return Ok(());
        }
        let itself = self.itself();
        let folder = itself.parent().filter(|folder| !folder.as_os_str().is_empty());
        File::open(folder.unwrap_or(Path::new(".")))?.sync_all()
    }

    /// Reads the state if it is valid and belongs to this design.
    pub(crate) fn load(&mut self) -> io::Result<Found> {
        match self.parsed()? {
            None => Ok(Found::Nothing),
            Some(Ok(state)) => Ok(Found::State(Box::new(state))),
            Some(Err(reason)) => Ok(Found::PutAside(self.put_aside()?, reason)),
        }
    }

    /// What the truck had learned and when this was saved; a file that cannot be used is left to
    /// [`load`](Self::load).
    pub(crate) fn learned(&mut self) -> (Learned, f64) {
        match self.parsed() {
            Ok(Some(Ok(state))) => (state.learned, state.saved_s),
            _ => (Learned::default(), 0.0),
        }
    }

    /// The content of the file, if there is one.
    fn parsed(&mut self) -> io::Result<Option<Result<State, StateError>>> {
        let bytes = self.bytes()?;
        self.known_crc32.get_or_insert(crc32(bytes.as_deref().unwrap_or_default()));
        Ok(bytes.map(|bytes| State::parse(&bytes, &self.owner)))
    }

    /// The bytes of the file, if there is one.
    fn bytes(&self) -> io::Result<Option<Vec<u8>>> {
        let file = match File::open(self.target.path()) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error),
        };
        // A device or a folder cannot contain a state and is not renamed.
        if !file.metadata()?.is_file() {
            return Err(io::Error::other("it is not a regular file"));
        }
        let mut bytes = Vec::new();
        file.take(LONGEST).read_to_end(&mut bytes)?;
        Ok(Some(bytes))
    }

    /// Renames the file to the first free `NAME.aside-N`.
    fn put_aside(&self) -> io::Result<PathBuf> {
        let itself = self.itself();
        for n in 1..=1000 {
            let mut name = itself.as_os_str().to_owned();
            name.push(format!(".aside-{n}"));
            let aside = PathBuf::from(name);
            // A link to a missing file is a file, too.
            if fs::symlink_metadata(&aside).is_err() {
                fs::rename(&itself, &aside)?;
                return Ok(aside);
            }
        }
        Err(io::Error::other("there are a thousand renamed states already; remove some"))
    }
}

/// The checksum of the bytes of a file.
fn crc32(bytes: &[u8]) -> u32 {
    checksum(&String::from_utf8_lossy(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cg_core::{Estimator, FilteredArx, Prior, Settings};
    use cg_output::{Files, Kind};
    use cg_vehicle::{Variant, Vehicle};

    fn target(folder: &Path) -> Target {
        Files::new(false).writes("--state", &folder.join("state.json"), Kind::State).unwrap()
    }

    fn subject(folder: &Path) -> (StateFile, Memory<f64>) {
        subject_named(folder, "a truck")
    }

    fn subject_named(folder: &Path, name: &str) -> (StateFile, Memory<f64>) {
        let vehicle = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
        let mut vehicle = Vehicle::load(vehicle).unwrap();
        name.clone_into(&mut vehicle.name);
        let design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
        let estimator: Estimator<f64, FilteredArx<f64>> =
            Estimator::new(design, Settings::truck(), Prior::standard());
        let owner = Owner::of(&vehicle, None, &design).unwrap();
        (StateFile::new(target(folder), owner), estimator.memory())
    }

    #[test]
    fn a_state_comes_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let (mut file, mut memory) = subject(folder.path());
        assert_eq!(file.load().unwrap(), Found::Nothing);
        memory.correlation[0][1] = 0.1 + 0.2;
        let load = SavedLoad { since_s: Some(0.3), ..SavedLoad::default() };
        file.save(&memory, 1.5, load, Learned::default()).unwrap();
        let scale = Some(Scale::AxleLoad);
        let braked = Strength { braking_mps2: 0.3, speeding_mps2: 0.4, ..Strength::default() };
        let unsteady = Strength { unsteady_mps2: 0.5, unsteady_sd: 0.02, ..braked };
        let strength = Strength { greatest: 0.7, sd: 0.1 + 0.2, ..unsteady };
        let gusts = r#"{"sum":{"slopes":[0.1,-0.2],"random":0.3},"maneuvers":2.0}"#;
        let gusts: Gusts = serde_json::from_str(gusts).unwrap();
        let load = SavedLoad {
            since_s: None,
            scale,
            lift_axle: LiftAxle::Raised,
            mass_sd_kg: Some(70.0),
            mass_is_of_another_load: true,
            height_is_doubted: true,
            strength,
            gusts,
            bank_sds_rad: Some([0.02, 0.0]),
            beside_sd_m: 0.1,
            part_kg: 400.0,
            trips_in_use: (3, Some(1.5)),
            wrong_signal: Some("a signal".to_owned()),
        };
        file.save(&memory, 2.5, load, Learned::default()).unwrap();
        let Found::State(state) = file.load().unwrap() else { panic!("a state") };
        assert_eq!((state.saved_s, state.load_since_s), (2.5, None));
        assert_eq!(state.memory((3, Some(1.5))), memory);
        for other in [(2, Some(1.5)), (3, Some(1.6)), (3, None)] {
            assert_eq!(state.memory(other), memory.of_another_design());
        }
        assert_eq!((state.beside_sd_m, state.part_kg), (0.1, 400.0));
        assert_eq!(state.bank_sds_rad, Some([0.02, 0.0]));
        assert_eq!(state.scale, Some(Scale::AxleLoad));
        assert!(state.mass_is_of_another_load && state.height_is_doubted);
        assert_eq!(state.lift_axle, LiftAxle::Raised);
        assert_eq!((state.strength, state.gusts), (strength, gusts));
        assert_eq!(
            (state.mass_sd_kg, state.wrong_signal.as_deref()),
            (Some(70.0), Some("a signal"))
        );
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// Every single bit is changed, and the file is cut off at every length.
    #[test]
    fn a_damaged_state_is_put_aside() {
        let folder = tempfile::tempdir().unwrap();
        let (mut file, memory) = subject(folder.path());
        file.save(&memory, 1.5, SavedLoad::default(), Learned::default()).unwrap();
        let good = fs::read(file.target.path()).unwrap();
        for bit in 0..good.len() * 8 {
            let mut bad = good.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            // White space at the end and the case of the checksum's digits have no effect.
            let harmless = bad.trim_ascii_end().eq_ignore_ascii_case(good.trim_ascii_end());
            assert!(harmless || State::parse(&bad, &file.owner).is_err(), "bit {bit}");
        }
        for length in 0..good.len() - 1 {
            assert!(State::parse(&good[..length], &file.owner).is_err(), "{length} bytes");
        }
        for n in 1..3 {
            fs::write(file.target.path(), &good[..40]).unwrap();
            let Found::PutAside(aside, reason) = file.load().unwrap() else { panic!("aside") };
            assert!(aside.to_string_lossy().ends_with(&format!("state.json.aside-{n}")));
            assert_eq!(reason.to_string(), "it has no checksum");
            assert_eq!(fs::read(aside).unwrap(), &good[..40]);
            assert_eq!(file.load().unwrap(), Found::Nothing);
        }
    }

    #[test]
    fn a_state_of_impossible_numbers_is_put_aside() {
        let folder = tempfile::tempdir().unwrap();
        let (mut file, mut memory) = subject(folder.path());
        memory.trailer_mass_kg = -1.0;
        file.save(&memory, 1.5, SavedLoad::default(), Learned::default()).unwrap();
        let Found::PutAside(_, reason) = file.load().unwrap() else { panic!("aside") };
        assert_eq!(reason, StateError::Unsound);
    }

    #[test]
    fn the_state_of_another_truck_is_put_aside() {
        let folder = tempfile::tempdir().unwrap();
        let (mut file, memory) = subject(folder.path());
        file.save(&memory, 1.5, SavedLoad::default(), Learned::default()).unwrap();
        let (mut file, _) = subject_named(folder.path(), "another truck");
        let Found::PutAside(_, reason) = file.load().unwrap() else { panic!("aside") };
        assert_eq!(reason, StateError::OtherDesign);
    }

    /// Each program writes after both have read.
    #[test]
    fn what_another_program_has_written_is_renamed() {
        let folder = tempfile::tempdir().unwrap();
        let (mut one, memory) = subject(folder.path());
        let (mut other, _) = subject(folder.path());
        let save = |file: &mut StateFile, saved_s: f64| {
            file.save(&memory, saved_s, SavedLoad::default(), Learned::default()).unwrap();
            file.aside.take()
        };
        assert_eq!((one.load().unwrap(), other.load().unwrap()), (Found::Nothing, Found::Nothing));
        assert_eq!((save(&mut one, 1.5), save(&mut one, 2.5)), (None, None));
        let ours = fs::read(one.target.path()).unwrap();
        let aside = save(&mut other, 3.5).unwrap();
        assert!(aside.ends_with("state.json.aside-1"), "{}", aside.display());
        assert_eq!(fs::read(aside).unwrap(), ours);
        assert_eq!(save(&mut other, 4.5), None);
        // They go on so for a while.
        for _ in 0..20 {
            assert!(save(&mut one, 4.6).is_some() && save(&mut other, 4.7).is_some());
        }
        let files = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(files, 3, "the state, and one aside of each");
        // A file that somebody has removed is written anew.
        fs::remove_file(one.target.path()).unwrap();
        assert_eq!(save(&mut one, 5.5), None);
    }

    /// The link remains, and a link to a file that is missing at present is not replaced.
    #[test]
    #[cfg(unix)]
    fn the_file_behind_a_link_is_renamed() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let kept = folder.path().join("kept");
        fs::create_dir(&kept).unwrap();
        fs::write(kept.join("truck.json"), "{\"format\":").unwrap();
        symlink("gone", kept.join("truck.json.aside-1")).unwrap();
        symlink("kept/truck.json", folder.path().join("state.json")).unwrap();
        let (mut file, memory) = subject(folder.path());
        let Found::PutAside(aside, _) = file.load().unwrap() else { panic!("aside") };
        assert!(aside.ends_with("kept/truck.json.aside-2"), "{}", aside.display());
        assert!(fs::read_link(kept.join("truck.json.aside-1")).unwrap().ends_with("gone"));
        file.save(&memory, 1.5, SavedLoad::default(), Learned::default()).unwrap();
        assert!(fs::symlink_metadata(file.target.path()).unwrap().is_symlink());
        assert!(matches!(file.load().unwrap(), Found::State(_)));
        assert_eq!(fs::read_dir(kept).unwrap().count(), 3);
    }
}
