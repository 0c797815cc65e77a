//! `giveway token`: makes, lists, rotates and revokes named tokens in the server's database, even while it runs.
//!
//! Main type: [`TokenArgs`]. A running server adopts changes within a second. Exit codes: 0 done, 1 refused. Refuses:
//! to print a token a second time.

use crate::server::{Config, Flags};
use anyhow::{Context, bail, ensure};
use clap::{Args, Subcommand};
use giveway_api::access::auth::{fresh_token, hash_of};
use giveway_api::wire::text::{parse_token_name, time_text, token_name};
use giveway_api::{Caller, MOST_TOKENS, Role};
use giveway_floor::text::name_fault;
use giveway_floor::time::{Span, Time};
use giveway_store::{AuditRow, TokenDraft, TokenRow, TokenTable};
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `token`.
#[derive(Args)]
pub struct TokenArgs {
    #[command(subcommand)]
    command: TokenCommand,
    /// The database, as for `giveway serve` [default: giveway.sqlite] [env: GIVEWAY_DATABASE]
    #[arg(long, value_name = "FILE", global = true)]
    database: Option<PathBuf>,
    /// Settings file of the server [env: GIVEWAY_CONFIG]
    #[arg(long, value_name = "FILE", global = true)]
    config: Option<PathBuf>,
    /// Print JSON
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Subcommand)]
enum TokenCommand {
    /// Make a token and print it, once.
    Add {
        /// The user of the token; the audit shows this name.
        name: String,
        /// viewer, operator, integrator, device or admin
        #[arg(long)]
        role: String,
        /// The worker or robot for which a device speaks, such as w1 or robot-2
        #[arg(long, value_name = "ID")]
        subject: Option<String>,
        /// After how many days the token expires; it does not expire if absent
        #[arg(long)]
        days: Option<u32>,
    },
    /// List all tokens, including invalid ones; the secrets are never listed.
    List,
    /// Replace a token by a new one, and print it, once.
    Rotate {
        /// The token's name, or its number such as t3.
        token: String,
    },
    /// Revoke a token.
    Revoke {
        /// The token's name, or its number such as t3.
        token: String,
    },
}

/// A token in the list.
#[derive(Serialize)]
struct TokenLine {
    id: String,
    name: String,
    role: String,
    subject: Option<String>,
    created: String,
    expires: Option<String>,
    revoked: Option<String>,
    last_used: Option<String>,
    /// The secret, if the token was just made.
    #[serde(skip_serializing_if = "Option::is_none")]
    token: Option<String>,
}

impl TokenLine {
    fn new(row: TokenRow, token: Option<String>) -> TokenLine {
        TokenLine {
            id: token_name(row.id),
            name: row.name,
            role: row.role,
            subject: row.subject,
            created: time_text(row.created),
            expires: row.expires.map(time_text),
            revoked: row.revoked.map(time_text),
            last_used: row.last_used.map(time_text),
            token,
        }
    }

    fn show(&self) {
        let TokenLine { id, name, role, subject, expires, revoked, last_used, .. } = self;
        let subject = subject.as_deref().map_or(String::new(), |s| format!(" of {s}"));
        let end = match (revoked, expires) {
            (Some(at), _) => format!(", revoked {at}"),
            (None, Some(at)) => format!(", until {at}"),
            (None, None) => String::new(),
        };
        let used = last_used.as_deref().map_or("never used".into(), |at| format!("used {at}"));
        println!("{id:<6} {name:<24} {role}{subject}, {used}{end}");
    }
}

impl TokenArgs {
    /// Runs the command.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let TokenArgs { command, database, config, json } = self;
        let config = Config::read(&Flags { database, config, ..Flags::default() })?;
        let path = &config.database;
        ensure!(path.is_file(), "there is no database {}: name it with --database FILE", path.display());
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let lines = runtime.block_on(async {
            let table = TokenTable::open(path).await?;
            let lines = carry_out(&table, command).await;
            table.close().await;
            lines
        })?;
        if json {
            println!("{}", serde_json::to_string_pretty(&lines)?);
        } else {
            for line in &lines {
                line.show();
                if let Some(token) = &line.token {
                    println!("{token}");
                    eprintln!("This token is not shown again: the database has its SHA-256 only.");
                }
            }
        }
        Ok(ExitCode::SUCCESS)
    }
}

async fn carry_out(table: &TokenTable, command: TokenCommand) -> anyhow::Result<Vec<TokenLine>> {
    let remedy = "this database has no tokens yet: start this version of the server once with it";
    ensure!(table.is_there().await?, remedy);
    let now = Time(jiff::Timestamp::now().as_microsecond());
    match command {
        TokenCommand::List => {
            Ok(table.all().await?.into_iter().map(|row| TokenLine::new(row, None)).collect())
        }
        TokenCommand::Add { name, role, subject, days } => {
            let all = table.all().await?;
            let holds = |row: &&TokenRow| row.revoked.is_none() && row.expires.is_none_or(|end| now < end);
            let remedy = "tokens hold, which is the limit: revoke one that nobody uses";
            ensure!(all.iter().filter(holds).count() < MOST_TOKENS, "{MOST_TOKENS} {remedy}");
            let token = fresh_token();
            let draft = draft((name.trim(), &role, subject), days, hash_of(&token), now)?;
            let id = table.add(&draft).await?.with_context(|| {
                format!("a token of \"{}\" holds: rotate or revoke it, or take another name", draft.name)
            })?;
            shown(table, id, Some(token), ("giveway token add", now)).await
        }
        TokenCommand::Rotate { token } => {
            let (id, fresh) = (find(table, &token).await?, fresh_token());
            let rotated = table.rotate(id, hash_of(&fresh), now).await?;
            ensure!(rotated, "\"{token}\" no longer holds: add another token");
            shown(table, id, Some(fresh), ("giveway token rotate", now)).await
        }
        TokenCommand::Revoke { token } => {
            let id = find(table, &token).await?;
            ensure!(table.revoke(id, now).await?, "\"{token}\" was revoked before");
            shown(table, id, None, ("giveway token revoke", now)).await
        }
    }
}

/// The token to keep, or what is wrong with it.
fn draft(
    (name, role, subject): (&str, &str, Option<String>),
    days: Option<u32>,
    hash: [u8; 32],
    now: Time,
) -> anyhow::Result<TokenDraft> {
    if let Some(fault) = name_fault(name, 64) {
        bail!("the name {name:?}: {fault}");
    }
    ensure!(!Caller::RESERVED.contains(&name), "\"{name}\" is the name of callers without a token");
    let words = Role::ALL.map(Role::word).join(", ");
    let role = Role::of_word(role).with_context(|| format!("\"{role}\" is not one of {words}"))?;
    match (role, &subject) {
        (Role::Device, None) => {
            bail!("name the worker or robot that the device speaks for with --subject ID")
        }
        (Role::Device, Some(_)) | (_, None) => {}
        (_, Some(_)) => bail!("--subject is for devices only"),
    }
    let expires = days.map(|n| now + Span::from_secs(24 * 3600) * i64::from(n));
    Ok(TokenDraft { name: name.into(), role: role.word().into(), subject, hash, created: now, expires })
}

/// The number of the token with this name or number; among several of a name, the one that was not revoked.
async fn find(table: &TokenTable, text: &str) -> anyhow::Result<i64> {
    let all = table.all().await?;
    let named = all.iter().filter(|t| t.name == text).max_by_key(|t| (t.revoked.is_none(), t.id));
    let numbered = || parse_token_name(text).and_then(|id| all.iter().find(|t| t.id == id));
    let found = named.or_else(numbered).with_context(|| format!("there is no token \"{text}\""))?;
    Ok(found.id)
}

/// The token to print, after the change to it was audited.
async fn shown(
    table: &TokenTable,
    id: i64,
    token: Option<String>,
    (what, now): (&str, Time),
) -> anyhow::Result<Vec<TokenLine>> {
    let entry = AuditRow {
        id: now.0,
        actor: "command line".into(),
        role: Role::Admin.word().into(),
        what: what.into(),
        subject: Some(token_name(id)),
        outcome: Some(200),
    };
    table.note_audit(&entry).await?;
    let row = table.one(id).await?.context("the token is gone")?;
    Ok(vec![TokenLine::new(row, token)])
}
