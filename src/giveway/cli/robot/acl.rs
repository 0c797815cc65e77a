//! `giveway robot acl`: the rights of robots and of Giveway at a broker, as Mosquitto's `acl_file` has them.
//!
//! Main type: [`AclArgs`]. Each robot may write what it says and read what is for it, and nothing of others. Refuses:
//! to give two clients one name.

use crate::cli::files::{read, write};
use anyhow::{Context, ensure};
use clap::Args;
use giveway_site::{ListedRobot, RobotsFile};
use giveway_vda5050::{TopicKind, Version};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `robot acl`.
#[derive(Args)]
pub struct AclArgs {
    /// The file of robots (docs/robots.md)
    robots: PathBuf,
    /// Giveway's user at the broker
    #[arg(long, value_name = "NAME", default_value = "giveway")]
    user: String,
    /// The users of robots: {name}, {manufacturer} and {serial} stand for those of the robot
    #[arg(long, value_name = "PATTERN", default_value = "{manufacturer}-{serial}")]
    robot_user: String,
    /// The first level or levels of topics [default: the file's, or uagv]
    #[arg(long, value_name = "NAME")]
    interface: Option<String>,
    /// Write to this file instead of standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl AclArgs {
    /// Writes the rights.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let refused = || format!("{} is refused", self.robots.display());
        let file = RobotsFile::parse(&read(&self.robots)?, None).with_context(refused)?;
        let interface = self.interface.as_deref().or(file.interface.as_deref()).unwrap_or("uagv");
        let users = self.users(&file.robots)?;
        write(self.out.as_deref(), &rights(interface, &self.user, &users))?;
        Ok(ExitCode::SUCCESS)
    }

    /// The robots with their users' names.
    fn users<'r>(&self, robots: &'r [ListedRobot]) -> anyhow::Result<Vec<(String, &'r ListedRobot)>> {
        let mut users: Vec<(String, &ListedRobot)> = Vec::new();
        for robot in robots {
            let user = (self.robot_user.replace("{name}", &robot.name))
                .replace("{manufacturer}", robot.address.manufacturer())
                .replace("{serial}", robot.address.serial());
            ensure!(
                user != self.user && users.iter().all(|(other, _)| *other != user),
                "two clients would be the user {user:?}: take another --user, or a --robot-user with {{name}}"
            );
            ensure!(
                !user.trim().is_empty() && !user.contains(['\n', '\r', ':']),
                "{user:?} cannot be a user of Mosquitto: take another --robot-user"
            );
            users.push((user, robot));
        }
        Ok(users)
    }
}

/// The text of the file.
fn rights(interface: &str, giveway: &str, users: &[(String, &ListedRobot)]) -> String {
    const HEAD: &str = "# Made by `giveway robot acl`. Everything that is not allowed here is forbidden.";
    let mut text = format!("{HEAD}\n\nuser {giveway}\n");
    for (_, robot) in users {
        text.push_str(&topics(interface, robot, |kind| !kind.is_from_robot()));
    }
    for (user, robot) in users {
        let _ = write!(text, "\n# {}\nuser {user}\n", robot.name);
        text.push_str(&topics(interface, robot, TopicKind::is_from_robot));
    }
    text
}

/// A robot's topics, each with the right of a client that writes some kinds of messages and reads the others.
fn topics(interface: &str, robot: &ListedRobot, writes: impl Fn(TopicKind) -> bool) -> String {
    let mut text = String::new();
    // A robot whose version is not set may speak either.
    let levels = match robot.version {
        Some(version) => vec![version],
        None => vec![Version::V2_1, Version::V3_0],
    };
    for version in levels {
        for kind in TopicKind::ALL.into_iter().filter(|kind| kind.is_in(version)) {
            let right = if writes(kind) { "write" } else { "read" };
            let _ = writeln!(text, "topic {right} {}", robot.address.topic(interface, version, kind));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = r#"{"giveway_robots": 1, "map_id": "lab", "kinds": {"tug": {}}, "robots": [
        {"name": "t1", "manufacturer": "maker", "serial": "1", "kind": "tug", "version": "2.0.0"},
        {"name": "t2", "manufacturer": "maker", "serial": "2", "kind": "tug", "version": "3.0.0"},
        {"name": "t3", "manufacturer": "other", "serial": "2", "kind": "tug"}]}"#;

    fn text_for(robot_user: &str) -> anyhow::Result<String> {
        let file = RobotsFile::parse(FILE, None).unwrap();
        let arguments = AclArgs {
            robots: PathBuf::new(),
            user: "giveway".into(),
            robot_user: robot_user.into(),
            interface: None,
            out: None,
        };
        Ok(rights("uagv", "giveway", &arguments.users(&file.robots)?))
    }

    /// The rights of a user.
    fn of<'t>(text: &'t str, user: &str) -> Vec<&'t str> {
        let user = format!("user {user}");
        let lines = text.lines().skip_while(|line| *line != user).skip(1);
        lines.take_while(|line| line.starts_with("topic")).collect()
    }

    #[test]
    fn a_robot_writes_what_it_says_and_giveway_what_is_for_it() {
        let text = text_for("{manufacturer}-{serial}").unwrap();
        let robot = of(&text, "maker-1");
        assert_eq!(
            robot,
            [
                "topic read uagv/v2/maker/1/order",
                "topic read uagv/v2/maker/1/instantActions",
                "topic write uagv/v2/maker/1/state",
                "topic write uagv/v2/maker/1/visualization",
                "topic write uagv/v2/maker/1/connection",
                "topic write uagv/v2/maker/1/factsheet",
            ]
        );
        let giveway = of(&text, "giveway");
        for line in &robot {
            let turned = if line.contains("read") {
                line.replace("read", "write")
            } else {
                line.replace("write", "read")
            };
            assert!(giveway.contains(&turned.as_str()), "{turned}");
        }
        assert!(of(&text, "maker-2").contains(&"topic read uagv/v3/maker/2/responses"), "{text}");
        assert_eq!(of(&text, "other-2").len(), 6 + 8, "a robot without a version may speak either");
        assert!(of(&text, "maker-1").iter().all(|line| !line.contains("maker/2")));
    }

    #[test]
    fn two_clients_of_one_name_are_refused() {
        for pattern in ["{serial}", "giveway"] {
            let said = text_for(pattern).unwrap_err().to_string();
            assert!(said.contains("--robot-user"), "{said}");
        }
        assert!(text_for("{name}").is_ok() && text_for("").is_err());
    }
}
