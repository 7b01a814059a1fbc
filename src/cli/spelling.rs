//! The library names its settings as a caller in Rust knows them, `near`; here they are spelled as options, --near.

use clap::CommandFactory;

use super::Cli;
use crate::error::Error;

/// A message of the library's with options where it has settings in backticks.
pub(super) fn spelled(message: &str) -> String {
    let options = options();
    let (mut text, mut rest) = (String::new(), message);
    while let Some((before, quoted)) = rest.split_once('`') {
        text += before;
        rest = quoted;
        let option = quoted.split_once('`').filter(|(name, _)| options.contains(&name.replace('_', "-")));
        match option {
            Some((name, after)) => {
                text += &format!("--{}", name.replace('_', "-"));
                rest = after;
            }
            None => text.push('`'),
        }
    }
    text + rest
}

/// The same of an error, whose argument may be an option.
pub(super) fn error(error: &Error) -> String {
    match error {
        Error::Usage { argument, .. } if options().contains(argument) => spelled(&format!("--{error}")),
        _ => spelled(&error.to_string()),
    }
}

/// The options of all commands.
fn options() -> Vec<String> {
    let cli = Cli::command();
    let options = cli.get_subcommands().flat_map(|command| command.get_arguments());
    options.filter_map(|option| option.get_long().map(String::from)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_become_options() {
        assert_eq!(spelled("Lower `lr`, or set `val_every`."), "Lower --lr, or set --val-every.");
        assert_eq!(spelled("the `file` of `near"), "the `file` of `near");
        assert_eq!(spelled("``near`"), "`--near");
        assert_eq!(
            error(&Error::usage("near", 5, "less than `far`")),
            "--near: found 5; expected less than --far"
        );
        assert_eq!(error(&Error::usage("component", 5, "a row")), "component: found 5; expected a row");
    }
}
