//! Submissions: the sub-folders of a folder, what each holds, and a name for its content.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::error::{Error, Input, Result};
use crate::files;
use crate::registry::all_rows;

/// Folders that aren't the student's own work.
const NOT_OURS: [&str; 6] = ["__pycache__", "__MACOSX", "venv", "env", "node_modules", "site-packages"];

/// Files of a submission: more are a data set or an environment.
const MOST_FILES: usize = 20_000;

/// Folders below folders.
const DEEPEST: usize = 16;

/// Bytes of a submission in Python, its data with it.
const MOST_BYTES: u64 = 256 << 20;

/// Answers beyond this are refused when they are read, whatever they hold.
const MOST_ANSWER: u64 = 64 << 20;

/// How a submission answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// It holds answers, in the judge's layout.
    Answers,
    /// It holds functions in Python.
    Python,
}

/// A sub-folder.
#[derive(Debug)]
pub(crate) struct Submission {
    /// The folder's name.
    pub(crate) name: String,
    /// The same as the name of a file, here and in a browser.
    pub(crate) slug: String,
    /// Where its content lies: below the folder, where an archive had a folder of its own.
    pub(crate) folder: PathBuf,
    /// What it holds, or why it can't be graded.
    pub(crate) holds: Result<Holds, String>,
}

/// What a submission holds.
#[derive(Debug)]
pub(crate) struct Holds {
    /// How it answers.
    pub(crate) kind: Kind,
    /// Its files, as paths below its folder, sorted.
    pub(crate) files: Vec<String>,
}

/// The submissions below a folder, sorted by name, and the names of what lies beside them. `out` is none of them; `asked` are the paths
/// at which answers lie.
///
/// # Errors
/// A folder that can't be read or has no sub-folder, or results that would lie within a submission.
pub(crate) fn find(
    folder: &Path,
    out: &Path,
    asked: &BTreeSet<String>,
) -> Result<(Vec<Submission>, Vec<String>)> {
    let (mut found, mut others) = (vec![], vec![]);
    let own = out.canonicalize().ok();
    if own.is_some() && own == folder.canonicalize().ok() {
        return Err(misplaced(out, "the folder of the submissions".into()));
    }
    for entry in fs::read_dir(folder).map_err(Error::reading(folder))? {
        let entry = entry.map_err(Error::reading(folder))?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(Error::reading(folder))?);
        let name = entry.file_name();
        let hidden = name.to_string_lossy().starts_with('.') || name == "__MACOSX";
        let there = path.canonicalize().ok();
        if hidden || (there.is_some() && there == own) {
            continue;
        }
        let shown = name.to_string_lossy().into_owned();
        if kind.is_dir() && there.zip(own.as_ref()).is_some_and(|(there, own)| own.starts_with(there)) {
            return Err(misplaced(out, format!("a folder inside of the submission {shown}")));
        }
        if kind.is_dir() || kind.is_symlink() {
            let slug = slug(name.as_encoded_bytes());
            let (folder, holds) = match kind.is_symlink() {
                true => (
                    path,
                    Err("a link to somewhere else, which isn't followed: copy what it leads to".into()),
                ),
                false => open(path, asked),
            };
            found.push(Submission { name: shown, slug, folder, holds });
        } else {
            others.push(shown);
        }
    }
    found.sort_by(|a, b| (&a.name, &a.slug).cmp(&(&b.name, &b.slug)));
    others.sort();
    if found.is_empty() {
        return Err(Error::input(Input {
            file: folder.display(),
            field: "submissions",
            found: "no sub-folder",
            expected: "one sub-folder a submission",
            remedy: "Name the folder that holds the submissions, each unpacked into a folder of its own.",
        }));
    }
    Ok((found, others))
}

/// Results in the wrong place.
fn misplaced(out: &Path, found: String) -> Error {
    let expected = "a folder that holds no submissions and isn't one";
    let remedy = "Choose another folder for the results.";
    Error::input(Input { file: out.display(), field: "`out`", found, expected, remedy })
}

/// A name that a file system, a link and a terminal take: letters, digits, dots and dashes; where that changes it, with a part of its hash.
fn slug(name: &[u8]) -> String {
    let plain = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_' | b'.');
    let safe: String = name.iter().map(|b| if plain(b) { char::from(*b) } else { '_' }).take(80).collect();
    // Nobody's name is what another's becomes.
    let hashed = safe
        .rsplit_once('-')
        .is_some_and(|(_, end)| end.len() == 8 && end.bytes().all(|b| b.is_ascii_hexdigit()));
    if safe.as_bytes() == name && !safe.starts_with('.') && !hashed {
        return safe;
    }
    format!("{}-{}", safe.trim_start_matches('.'), &hex(&Sha256::digest(name))[..8])
}

/// What a folder holds, and where.
fn open(mut folder: PathBuf, asked: &BTreeSet<String>) -> (PathBuf, Result<Holds, String>) {
    loop {
        let mut files = vec![];
        if let Err(reason) = scan(&folder, "", 0, &mut files) {
            return (folder, Err(reason));
        }
        files.sort();
        // A folder in the folder, as archives have it, and no row's.
        let top = |file: &str| file.split_once('/').map_or(String::new(), |(top, _)| top.to_string());
        let tops: BTreeSet<String> = files.iter().map(|file| top(file)).collect();
        let rows = |name: &str| all_rows().any(|row| row.name == name);
        match tops.first().filter(|top| tops.len() == 1 && !top.is_empty() && !rows(top)) {
            Some(inner) => folder = folder.join(inner),
            None => {
                let holds = kind(&files, asked).map(|kind| Holds { kind, files });
                return (folder, holds);
            }
        }
    }
}

/// How a submission with these files answers, or what is wrong with it.
fn kind(files: &[String], asked: &BTreeSet<String>) -> Result<Kind, String> {
    let ends = |end: &str| files.iter().find(|file| file.to_lowercase().ends_with(end));
    if files.iter().any(|file| asked.contains(file)) {
        return Ok(Kind::Answers);
    }
    if ends(".py").is_some() {
        return Ok(Kind::Python);
    }
    Err(match (files.first(), ends(".ipynb"), ends(".zip").or(ends(".gz")), ends(".npz")) {
        (None, ..) => "an empty folder".into(),
        (_, Some(file), ..) => format!(
            "no answers and no Python file: {file} is a notebook; its functions belong into a .py file"
        ),
        (_, _, Some(file), _) => format!("no answers and no Python file: {file} has to be unpacked"),
        (_, _, _, Some(file)) => format!(
            "no answers where cases.json has them, such as {}; but {file}",
            asked.first().map_or("", String::as_str)
        ),
        (Some(file), ..) => format!("no answers and no Python file, but {file}"),
    })
}

/// The regular files below a folder. Links, pipes and devices are refused: they lead outside, or never end.
pub(super) fn scan(folder: &Path, below: &str, depth: usize, found: &mut Vec<String>) -> Result<(), String> {
    let unreadable = |error: std::io::Error| format!("{below}: can't be read: {error}");
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let kind = entry.file_type().map_err(unreadable)?;
        let path = format!("{below}{name}");
        if name.starts_with('.') || (kind.is_dir() && NOT_OURS.contains(&&*name)) {
            continue;
        }
        if kind.is_symlink() {
            return Err(format!("{path} is a link, which isn't followed: copy what it leads to"));
        }
        if kind.is_dir() && depth < DEEPEST {
            scan(&entry.path(), &format!("{path}/"), depth + 1, found)?;
        } else if kind.is_file() {
            found.push(path);
        } else {
            return Err(format!("{path} is no regular file, or lies too deep"));
        }
        if found.len() > MOST_FILES {
            return Err(format!("more than {MOST_FILES} files: leave data sets and environments out"));
        }
    }
    Ok(())
}

impl Submission {
    /// A name for what is graded: `salt` and everything that the submission holds. The same name, the same marks.
    pub(crate) fn key(&self, salt: &str) -> Result<String, String> {
        let mut hash = Sha256::new();
        let mut add = |bytes: &[u8]| {
            hash.update((bytes.len() as u64).to_le_bytes());
            hash.update(bytes);
        };
        add(salt.as_bytes());
        match &self.holds {
            Err(reason) => add(reason.as_bytes()),
            Ok(Holds { kind, files }) => {
                let mut left = MOST_BYTES;
                for file in files {
                    let path = self.folder.join(file);
                    let size = fs::metadata(&path).map_err(|error| format!("{file}: {error}"))?.len();
                    add(file.as_bytes());
                    if *kind == Kind::Python {
                        left = left.checked_sub(size).ok_or_else(|| too_large(file))?;
                    }
                    if *kind == Kind::Answers && size > MOST_ANSWER {
                        add(&size.to_le_bytes());
                    } else {
                        add(&files::read(&path, MOST_BYTES).map_err(|error| error.to_string())?);
                    }
                }
            }
        }
        Ok(hex(&hash.finalize()))
    }

    /// Copies a submission's files below `to`: what runs there can't change what was handed in.
    pub(crate) fn copy(&self, to: &Path) -> Result<(), String> {
        let files = &self.holds.as_ref().map_err(String::clone)?.files;
        for file in files {
            let (from, to) = (self.folder.join(file), to.join(file));
            let copy = || -> std::io::Result<u64> {
                fs::create_dir_all(to.parent().unwrap_or(&to))?;
                fs::copy(&from, &to)
            };
            copy().map_err(|error| format!("{file} can't be copied: {error}"))?;
        }
        Ok(())
    }
}

fn too_large(file: &str) -> String {
    format!("more than {} MiB, {file} with it: leave data and checkpoints out", MOST_BYTES >> 20)
}

/// Bytes as text.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_safe_and_nobodys_is_anothers() {
        assert_eq!(slug(b"ada-lovelace_2"), "ada-lovelace_2");
        let names = ["a b", "a_b", "a<b", "..", ".git", "Zo\u{eb}", "index", "-rf", "\u{1b}[31m"];
        let slugs: BTreeSet<String> = names.iter().map(|name| slug(name.as_bytes())).collect();
        assert_eq!(slugs.len(), names.len());
        assert!(
            slugs
                .iter()
                .all(|slug| !slug.starts_with('.') && slug.is_ascii() && !slug.contains(['<', ' ', '/']))
        );
        let taken = slug(b"a b");
        assert_ne!(slug(taken.as_bytes()), taken);
        assert!(slug(&[b'a'; 255]).len() < 100);
    }

    #[test]
    fn what_a_folder_holds_is_told_by_its_files() {
        let asked = BTreeSet::from(["volume_render/forward-a.npz".to_string()]);
        let told = |files: &[&str]| kind(&files.iter().map(ToString::to_string).collect::<Vec<_>>(), &asked);
        assert_eq!(told(&["f.py"]), Ok(Kind::Python));
        assert_eq!(told(&["f.py", "volume_render/forward-a.npz"]), Ok(Kind::Answers));
        for (files, words) in [
            (&[][..], "empty"),
            (&["a.ipynb"], "notebook"),
            (&["a.zip"], "unpacked"),
            (&["x/forward-a.npz"], "such as volume_render/forward-a.npz"),
            (&["a.txt"], "but a.txt"),
        ] {
            assert!(told(files).unwrap_err().contains(words), "{files:?}");
        }
    }
}
