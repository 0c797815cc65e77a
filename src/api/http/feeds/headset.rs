//! One connection of a headset: poses in, guidance out.
//!
//! Main function: [`fn@feed`]. Guidance is sent at once when it changed, else four times a second; guidance that cannot
//! be sent in time is replaced by newer. Refuses: to wait for a client, and to speak a version that it does not know.

use crate::dto::guidance::{GuidanceContext, GuidanceDto, GuidanceKey, PoseRefDto, guidance};
use crate::dto::names::Names;
use crate::feed::hub::{Connection, Told, head_of};
use crate::feed::intake::clock::{Exchange, PingOutcome};
use crate::feed::intake::joints::JointGate;
use crate::feed::intake::{PoseFault, PoseIntake, TakenPose, pairs};
use crate::feed::lights::{CellLightsDto, CellTold};
use crate::feed::message::FeedMessage;
use crate::feed::thin::RateLimiter;
use crate::feed::version::{VERSIONS, encoded, spoken};
use crate::feed::warn::Warnings;
use crate::feed::wire;
use crate::feed::wire::{AnchorSaid, HeadsetMessage, HelloSaid, PoseSaid};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::extract::PathPart;
use crate::wire::text::{assignment_name, parse_assignment, worker_name};
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade, close_code};
use axum::http::StatusCode;
use axum::response::Response;
use giveway_fleet::{Ask, GuidanceState};
use giveway_floor::id::{AssignmentId, WorkerId};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::{feed, remedies, requests};
use giveway_floor::time::{Span, Time};
use std::collections::VecDeque;
use std::pin::pin;
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::timeout;

/// The longest message, in bytes: both hands with all joints, twice.
const MESSAGE: usize = 32 * 1024;

/// How long the first message may take to arrive.
const GREETING: Duration = Duration::from_secs(10);

/// How long sending one message may take.
const SEND: Duration = Duration::from_secs(2);

/// The longest interval between two guidance messages.
const REFRESH: Span = Span::from_millis(250);

/// A connection with no message for this long, not even an answer to a ping, is gone.
const SILENT: Span = Span::from_secs(30);

/// After this many unreadable messages in a row, the client is taken to be foreign.
const MOST_UNREADABLE: u32 = 100;

/// The most pings whose answers are awaited.
const MOST_PINGS: usize = 8;

/// The most reports that wait for the fleet's answers.
const MOST_REPORTS: usize = 4;

/// How many poses are remembered, to tell the client which of them guidance took into account.
const RECENT: usize = 256;

/// Open the feed of a worker's headset, phone or gateway: JSON texts. The client sends `hello` with the versions that
/// it speaks and gets `welcome`; it answers every `ping` with a `pong`; it sends `anchors` until they are `aligned`,
/// then `pose` up to 60 times a second. The server sends `guidance` at once when it changed, else four times a second.
/// Offer the protocol `giveway`, and `bearer.TOKEN` if a token is needed. docs/headset.md shows all messages.
#[utoipa::path(get, path = "/v1/workers/{id}/feed", tag = "people", operation_id = "openWorkerFeed",
    params(("id" = String, Path, example = "w1")), responses(
    (status = 101, description = "The feed begins"),
    (status = 426, description = "Not a WebSocket")))]
pub async fn feed(
    Called(api): Called,
    PathPart(id): PathPart,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Problem> {
    api.queue()?;
    let worker = api.feeds.worker(&id)?;
    let upgrade = upgrade.map_err(|e| {
        let detail = format!("this is a WebSocket: connect with ws:// or wss:// ({})", e.body_text());
        let detail = requests::malformed(detail);
        Problem::new(StatusCode::UPGRADE_REQUIRED, "websocket", "A WebSocket is needed", detail)
    })?;
    let upgrade = upgrade.protocols(["giveway"]).max_message_size(MESSAGE).max_write_buffer_size(4 << 20);
    Ok(upgrade.on_upgrade(move |socket| async move {
        api.metrics.feeds.inc();
        serve(&api, worker, socket).await;
        api.metrics.feeds.dec();
    }))
}

/// Why a connection ends.
enum SessionEnd {
    /// The client is gone, or does not accept what it is sent.
    Gone,
    /// The server closes the connection, with a code and a reason.
    Bye(u16, Sentence),
}

/// One connection.
struct Session<'a> {
    api: &'a Api,
    /// The version of the protocol.
    version: u32,
    worker: WorkerId,
    socket: WebSocket,
    connection: Connection,
    intake: PoseIntake,
    limiter: RateLimiter<(Time, Box<PoseSaid>)>,
    warnings: Warnings,
    pings: VecDeque<(u64, Time)>,
    next_ping: u64,
    /// Poses that were handed on: time of receipt, epoch, number.
    handed: VecDeque<(Time, u32, u64)>,
    heading: Option<f64>,
    counted: (u64, u64),
    last_heard: Time,
    unreadable: u32,
    /// Assignments that the wearer has reported as done and that the fleet has not answered yet.
    reports: JoinSet<(AssignmentId, Option<Sentence>)>,
    sent: Option<GuidanceKey>,
    sent_at: Time,
    /// Detects impossible hands.
    joints: JointGate,
    /// What the wearer was last told about a station.
    lights: Option<CellTold>,
}

/// Serves one client until it leaves, stalls, is replaced, or the server shuts down.
async fn serve(api: &Api, worker: WorkerId, mut socket: WebSocket) {
    let late =
        || requests::malformed("no hello within ten seconds: the first message is hello, with versions");
    let speed = api.moment().simulation.map_or(1, |simulation| simulation.speed);
    let greeted = timeout(GREETING, greeting(&mut socket)).await;
    // A client that has not named its version gets version 1, which has bare text.
    let mut version = 1;
    let end = match greeted.unwrap_or_else(|_| Err(SessionEnd::Bye(close_code::POLICY, late()))) {
        Ok((both_speak, _)) if speed > 1 => {
            version = both_speak;
            Some(SessionEnd::Bye(close_code::POLICY, feed::floor_is_fast(speed)))
        }
        Ok((both_speak, hello)) => {
            version = both_speak;
            let Some(connection) = api.feeds.connect(worker) else { return };
            let now = (api.now)();
            let counts = connection.told.borrow().counts;
            let mut session = Session {
                api,
                version,
                worker,
                socket,
                connection,
                intake: PoseIntake::new(worker, hello.frame),
                limiter: RateLimiter::default(),
                warnings: Warnings::default(),
                pings: VecDeque::new(),
                next_ping: 1,
                handed: VecDeque::new(),
                heading: None,
                counted: (counts.jumps, counts.absurd),
                last_heard: now,
                unreadable: 0,
                reports: JoinSet::new(),
                sent: None,
                sent_at: Time(0),
                joints: JointGate::default(),
                lights: None,
            };
            let end = session.run(&hello).await.err();
            api.feeds.disconnect(worker, &session.connection);
            socket = session.socket;
            end
        }
        Err(end) => Some(end),
    };
    if let Some(SessionEnd::Bye(code, reason)) = end {
        let text = encoded(&FeedMessage::Error { text: reason.clone() }, version);
        _ = timeout(SEND, socket.send(Message::Text(text.into()))).await;
        let frame = CloseFrame { code, reason: short(reason.text()).into() };
        _ = timeout(SEND, socket.send(Message::Close(Some(frame)))).await;
    }
}

/// What the client is told about marks that do not fit the others.
fn left_out(said: &[AnchorSaid], dropped: &[usize]) -> Sentence {
    let name = |i: &usize| said.get(*i).and_then(|a| a.mark.clone()).unwrap_or_else(|| i.to_string());
    feed::marks_left_out(dropped.iter().map(name).collect::<Vec<String>>())
}

/// The reason cut to fit a close frame, which has room for 123 bytes.
fn short(reason: &str) -> &str {
    let end = (0..=reason.len().min(120)).rev().find(|i| reason.is_char_boundary(*i));
    &reason[..end.unwrap_or(0)]
}

/// Reads the first message; returns a version that both sides speak.
async fn greeting(socket: &mut WebSocket) -> Result<(u32, HelloSaid), SessionEnd> {
    let policy = |reason: &str| SessionEnd::Bye(close_code::POLICY, requests::malformed(reason));
    let message = loop {
        match socket.recv().await {
            Some(Ok(Message::Text(text))) => break text,
            Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
            Some(Ok(Message::Binary(_))) => return Err(policy("messages are JSON texts")),
            _ => return Err(SessionEnd::Gone),
        }
    };
    match serde_json::from_str::<HeadsetMessage>(&message) {
        Ok(HeadsetMessage::Hello(hello)) => match spoken(&hello.versions) {
            Some(version) => Ok((version, hello)),
            None => Err(policy(&format!(
                "this server speaks versions {VERSIONS:?} of the feed, the client only {:?}",
                &hello.versions[..hello.versions.len().min(8)]
            ))),
        },
        Ok(_) => Err(policy("the first message is hello, with the versions that you speak")),
        Err(e) => Err(policy(&format!("the first message is not a hello: {e}"))),
    }
}

impl Session<'_> {
    async fn run(&mut self, hello: &HelloSaid) -> Result<(), SessionEnd> {
        let name = self.api.feeds.name(self.worker);
        let welcome = FeedMessage::Welcome {
            version: self.version,
            worker: worker_name(self.worker),
            name: name.map(|pseudonym| self.api.pseudonyms.shown(&self.api.caller, self.worker, &pseudonym)),
            frame: hello.frame,
            epoch: self.intake.epoch(),
            aligned: self.intake.alignment().is_some(),
            rate_hz: 60,
        };
        self.send(welcome).await?;
        let (api, mut closing) = (self.api, self.api.closing.clone());
        let mut ended = pin!(api.gate.ended(&api.caller, &api.now));
        loop {
            self.ping().await?;
            let wait = self.wait();
            tokio::select! {
                biased;
                changed = self.connection.told.changed() => {
                    changed.map_err(|_| SessionEnd::Gone)?;
                    self.light().await?;
                    self.guide(false).await?;
                }
                taken = self.connection.taken.changed() => {
                    taken.map_err(|_| SessionEnd::Gone)?;
                    if *self.connection.taken.borrow() != self.connection.number {
                        return Err(SessionEnd::Bye(close_code::POLICY, feed::replaced_by_another()));
                    }
                }
                () = async { _ = closing.wait_for(|closing| *closing).await.is_ok() } => {
                    return Err(SessionEnd::Bye(close_code::AWAY, feed::server_shutting_down()));
                }
                () = &mut ended => return Err(SessionEnd::Bye(close_code::POLICY, feed::token_ended())),
                Some(Ok((id, refused))) = self.reports.join_next() => self.reported(id, refused).await?,
                () = tokio::time::sleep(wait) => self.tick().await?,
                message = self.socket.recv() => self.hear(message).await?,
            }
        }
    }

    /// How long until something is due.
    fn wait(&self) -> Duration {
        let now = (self.api.now)();
        let dues = [self.intake.clock.due(), self.limiter.due(), Some(self.sent_at + REFRESH)];
        let first = dues.into_iter().flatten().min().unwrap_or(now);
        Duration::from_micros((first - now).0.max(0).unsigned_abs())
    }

    async fn tick(&mut self) -> Result<(), SessionEnd> {
        let now = (self.api.now)();
        if now - self.last_heard > SILENT {
            return Err(SessionEnd::Gone);
        }
        if let Some((received, pose)) = self.limiter.ready(now) {
            self.hand(&pose, received).await?;
        }
        if now - self.sent_at >= REFRESH { self.guide(true).await } else { Ok(()) }
    }

    async fn hear(&mut self, message: Option<Result<Message, axum::Error>>) -> Result<(), SessionEnd> {
        let now = (self.api.now)();
        self.last_heard = now;
        let text = match message {
            Some(Ok(Message::Text(text))) => text,
            Some(Ok(Message::Ping(_) | Message::Pong(_))) => return Ok(()),
            Some(Ok(Message::Binary(_))) => return self.unreadable("messages are JSON texts").await,
            Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(SessionEnd::Gone),
        };
        let said = match wire::read(&text) {
            Ok(said) => said,
            Err(e) => return self.unreadable(&format!("not a message of this feed: {e}")).await,
        };
        self.unreadable = 0;
        match said {
            HeadsetMessage::Pose(pose) => match self.limiter.offer((now, pose), now) {
                Some((received, pose)) => self.hand(&pose, received).await,
                None => Ok(()),
            },
            HeadsetMessage::Pong { id, t1, t2 } => self.pong(id, t1, t2, now).await,
            HeadsetMessage::Anchors { pairs } => self.align(&pairs).await,
            HeadsetMessage::Reset => {
                self.intake.reset();
                let aligned = self.intake.alignment().is_some();
                self.send(FeedMessage::Epoch { epoch: self.intake.epoch(), aligned }).await
            }
            HeadsetMessage::Resync => {
                self.intake.clock.resync();
                Ok(())
            }
            HeadsetMessage::Done { assignment } => self.done(&assignment).await,
            HeadsetMessage::Bye => {
                // Like poses, this does not wait for the journal. A refusal changes nothing: silence has the same
                // effect.
                let (api, worker) = (self.api.clone(), self.worker);
                tokio::spawn(async move { api.ask(Ask::sign_off(worker)).await });
                Err(SessionEnd::Bye(1000, requests::malformed("goodbye")))
            }
            HeadsetMessage::Ack { version } => {
                self.api.feeds.acknowledge(self.worker, version);
                Ok(())
            }
            HeadsetMessage::Hello(_) => {
                self.warn("hello", 1, requests::malformed("hello is the first message only")).await
            }
        }
    }

    /// Reports to the fleet that the wearer is done. Poses do not wait for the journal, so the answer comes later.
    async fn done(&mut self, said: &str) -> Result<(), SessionEnd> {
        let Some(id) = parse_assignment(said) else {
            let text = requests::malformed("name the assignment as guidance does, such as a3");
            return self.warn("done", 1, text).await;
        };
        if self.reports.len() >= MOST_REPORTS {
            let text = requests::malformed("too many at once: wait for the answers");
            return self.warn("done", 1, text).await;
        }
        let (api, worker) = (self.api.clone(), self.worker);
        self.reports.spawn(async move {
            let problem = api.ask(Ask::finish(worker, id)).await.err();
            (id, problem.map(|p| p.sentence()))
        });
        Ok(())
    }

    async fn reported(&mut self, id: AssignmentId, refused: Option<Sentence>) -> Result<(), SessionEnd> {
        self.send(FeedMessage::Done { assignment: assignment_name(id), refused }).await
    }

    /// Reads a pose and passes it on.
    async fn hand(&mut self, said: &PoseSaid, received: Time) -> Result<(), SessionEnd> {
        self.api.metrics.poses_received.inc();
        let fault = match self.intake.take(said, received) {
            Ok(mut taken) => {
                // A late pose comes after what is already known of hands.
                if taken.fault.is_none() {
                    self.drop_hands(said, &mut taken, received).await?;
                }
                self.heading = taken.sighting.heading;
                if self.handed.len() == RECENT {
                    self.handed.pop_front();
                }
                self.handed.push_back((received, said.epoch, said.seq));
                if !self.api.feeds.hand(&self.connection, taken.sighting, taken.senses, received) {
                    self.api.metrics.refused("full");
                }
                taken.fault.or(taken.is_askew.then_some(PoseFault::Askew))
            }
            Err(fault) => {
                self.api.metrics.refused(fault.word());
                Some(fault)
            }
        };
        match fault {
            Some(fault) => self.warn(fault.word(), 1, fault.sentence()).await,
            None => Ok(()),
        }
    }

    /// Leaves out impossible hands, and tells the client.
    async fn drop_hands(
        &mut self,
        said: &PoseSaid,
        taken: &mut TakenPose,
        received: Time,
    ) -> Result<(), SessionEnd> {
        let head = head_of(&taken.sighting, &taken.senses);
        let times = (taken.sighting.seen, received);
        let refused = self.joints.pass(said.hands.as_ref(), &mut taken.senses, head, times);
        if refused == 0 {
            return Ok(());
        }
        self.api.metrics.hands_refused.inc_by(refused);
        self.warn("hands", refused, feed::hand_left_out()).await
    }

    async fn unreadable(&mut self, text: &str) -> Result<(), SessionEnd> {
        self.unreadable += 1;
        if self.unreadable > MOST_UNREADABLE {
            let reason =
                requests::malformed(format!("{MOST_UNREADABLE} messages in a row could not be read"));
            return Err(SessionEnd::Bye(close_code::POLICY, reason));
        }
        self.api.metrics.refused("unreadable");
        self.warn("unreadable", 1, requests::malformed(text)).await
    }

    async fn ping(&mut self) -> Result<(), SessionEnd> {
        let now = (self.api.now)();
        if self.intake.clock.due().is_some_and(|due| due > now) {
            return Ok(());
        }
        if self.pings.len() == MOST_PINGS {
            self.pings.pop_front();
        }
        let id = self.next_ping;
        self.next_ping += 1;
        self.intake.clock.pinged(now);
        self.pings.push_back((id, now));
        self.send(FeedMessage::Ping { id }).await
    }

    async fn pong(&mut self, id: u64, t1: f64, t2: f64, now: Time) -> Result<(), SessionEnd> {
        // Each ping gets one answer; other answers are not to this server's pings.
        let Some(i) = self.pings.iter().position(|(asked, _)| *asked == id) else { return Ok(()) };
        let Some((_, asked)) = self.pings.remove(i) else { return Ok(()) };
        let outcome = self.intake.clock.take(Exchange { asked, got_ms: t1, answered_ms: t2, heard: now });
        self.api.feeds.clock_error(self.worker, self.intake.clock.error(now));
        match outcome {
            PingOutcome::Taken => Ok(()),
            outcome @ (PingOutcome::First | PingOutcome::Jumped) => {
                let error = self.intake.clock.error(now).unwrap_or_default();
                let jumped = outcome == PingOutcome::Jumped;
                let error_ms = error.0 as f64 / 1000.0;
                self.send(FeedMessage::Clock { error_ms, jumped }).await
            }
            PingOutcome::Absurd => {
                let text = "t1 and t2 are milliseconds of one monotonic clock, t1 before t2";
                self.warn("pong", 1, requests::malformed(text)).await
            }
        }
    }

    async fn align(&mut self, said: &[AnchorSaid]) -> Result<(), SessionEnd> {
        let fit = pairs(said, &self.api.map).map_err(|text| (text, remedies::do_correct_message()));
        let fit = fit.and_then(|pairs| {
            let touched = self.api.feeds.are_new_marks(self.worker, &pairs);
            match self.intake.align(&pairs, touched) {
                Ok(alignment) => Ok((alignment.clone(), pairs)),
                Err(misfit) => Err((misfit.sentence(), misfit.remedy())),
            }
        });
        let fit = fit.map(|(alignment, pairs)| {
            self.api.feeds.note_marks(self.worker, pairs);
            alignment
        });
        let (provisional, dropped) =
            fit.as_ref().map_or((false, Vec::new()), |a| (a.is_provisional(), a.dropped.clone()));
        let answer = match fit {
            Ok(a) => FeedMessage::Aligned {
                provisional,
                epoch: self.intake.epoch(),
                theta: a.theta,
                shift: [a.shift.x, a.shift.y],
                rms_m: a.rms_m,
                heading_error: a.heading_error,
                dropped: a.dropped,
            },
            Err((reason, remedy)) => FeedMessage::Refused {
                what: "anchors",
                reason,
                remedy,
                epoch: self.intake.epoch(),
                aligned: self.intake.alignment().is_some(),
            },
        };
        self.send(answer).await?;
        if !dropped.is_empty() {
            self.warn("mark-left-out", dropped.len() as u64, left_out(said, &dropped)).await?;
        }
        if provisional { self.warn("one-line", 1, feed::marks_on_one_line()).await } else { Ok(()) }
    }

    /// Sends what is to be picked at the wearer's station, if that changed.
    async fn light(&mut self) -> Result<(), SessionEnd> {
        let told = self.connection.told.borrow().cell.clone();
        let is_same = match (&told, &self.lights) {
            (Some(now), Some(before)) => now.looks_like(before),
            (now, before) => now.is_none() && before.is_none(),
        };
        if is_same {
            return Ok(());
        }
        let lights = CellLightsDto::new(told.as_ref(), &self.api.map);
        self.send(FeedMessage::Cell(Box::new(lights))).await?;
        let warned = told.as_ref().filter(|t| t.warning.is_some()).and_then(|t| t.warned_of);
        let before = self.lights.as_ref().and_then(|t| t.warned_of);
        if let Some(seen) = warned.filter(|seen| before != Some(*seen)) {
            let took = (self.api.now)() - seen;
            self.api.metrics.hand_to_warning.observe(took.as_secs_f64());
        }
        self.lights = told;
        Ok(())
    }

    /// Sends guidance: at once if it changed, else only when it is due.
    async fn guide(&mut self, due: bool) -> Result<(), SessionEnd> {
        let Told { at, guidance: told, counts, .. } = self.connection.told.borrow_and_update().clone();
        let key = GuidanceKey::of(told.as_ref());
        self.api.metrics.poses_thinned.inc_by(std::mem::take(&mut self.limiter.thinned));
        let changed = self.sent != Some(key);
        let now = (self.api.now)();
        if !changed && !due && now - self.sent_at < REFRESH {
            return Ok(());
        }
        let considered = self.handed.iter().rev().find(|(received, ..)| *received <= at).copied();
        let moment = self.api.moment();
        let names = Names { map: &self.api.map, view: &moment.view };
        let pose = considered.map(|(_, epoch, seq)| PoseRefDto { epoch, seq });
        let context = GuidanceContext { names, heading: self.heading, now };
        let message = GuidanceDto { pose, ..guidance(told.as_ref(), context) };
        let stopped = key.state == GuidanceState::Stop;
        let began = self.sent.is_none_or(|sent| sent.state != GuidanceState::Stop);
        (self.sent, self.sent_at) = (Some(key), now);
        self.send(FeedMessage::Guidance(Box::new(message))).await?;
        if let Some((received, ..)) = considered.filter(|_| stopped && began) {
            let took = (self.api.now)() - received;
            self.api.metrics.pose_to_stop.observe(took.as_secs_f64());
        }
        let (jumps, absurd) = (counts.jumps - self.counted.0.min(counts.jumps), counts.absurd);
        let absurd = absurd - self.counted.1.min(absurd);
        self.counted = (counts.jumps, counts.absurd);
        if jumps > 0 {
            self.warn("jump", jumps, feed::pose_jumped()).await?;
        }
        if absurd > 0 {
            self.warn("impossible", absurd, feed::nobody_can_be_there()).await?;
        }
        Ok(())
    }

    async fn warn(&mut self, code: &'static str, count: u64, text: Sentence) -> Result<(), SessionEnd> {
        match self.warnings.note(code, count, (self.api.now)()) {
            Some(count) => self.send(FeedMessage::Warning { code: code.into(), count, text }).await,
            None => Ok(()),
        }
    }

    async fn send(&mut self, message: FeedMessage) -> Result<(), SessionEnd> {
        let message = Message::Text(encoded(&message, self.version).into());
        match timeout(SEND, self.socket.send(message)).await {
            Ok(Ok(())) => Ok(()),
            _ => Err(SessionEnd::Gone),
        }
    }
}
