//! Shows a recording: the same pages and feeds, with the recorded fleet.
//!
//! Main type: [`Show`]. One player runs at the recorded pace and answers questions; another runs ahead as fast as it
//! can and writes its frames into a folder of its own, so that the page can seek to any moment. Lists are kept in
//! memory; requests are refused, since the past accepts none. Refuses: a database.

use crate::server::ahead::LastForecasts;
use crate::server::clock::Clock;
use crate::server::listen;
use crate::server::measure::Measure;
use crate::server::past::PastLists;
use crate::server::recorder::FrameRecorder;
use anyhow::Context;
use giveway_api::recording::{Folder, Limits, Rotation};
use giveway_api::{
    Alarms, Api, AuditLog, Caller, Feeds, Gate, Interop, KindChecks, Live, MapPort, Moment, QUESTIONS,
    Question, SharedHistory, router,
};
use giveway_fleet::alarm::{AlarmKind, FloorWatch, LoopHealth};
use giveway_fleet::history::{History, LoopTimes};
use giveway_fleet::{Fleet, View};
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::time::{Span, Time};
use giveway_sim::{Player, Turn};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;

/// Interval between views, in recorded time at normal speed.
const PUBLISH: Span = Span::from_millis(95);

/// Interval between checks of the floor for alarms.
const LOOKS: Span = Span::from_secs(1);

/// A recording that is being shown.
pub struct Show {
    address: SocketAddr,
    http: JoinHandle<std::io::Result<()>>,
    play: Option<JoinHandle<anyhow::Result<()>>>,
    _closing: watch::Sender<bool>,
    _reels: Recordings,
}

/// The folder of frames, which is deleted with the show.
struct Recordings(PathBuf);

impl Recordings {
    fn of_this_process() -> Recordings {
        Recordings(std::env::temp_dir().join(format!("giveway-replay-{}", std::process::id())))
    }
}

impl Drop for Recordings {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The folder is for this show only, so it has no limits.
const ALL: Limits = Limits { age_s: f64::INFINITY, bytes: u64::MAX };

impl Show {
    /// Begins to show a recording. `ahead` plays the same recording.
    ///
    /// # Errors
    /// If the address is taken, or the folder of frames cannot be made.
    pub async fn start(
        player: Player,
        ahead: Player,
        listen_at: SocketAddr,
        speed: f64,
    ) -> anyhow::Result<Show> {
        let taken = || format!("cannot listen on {listen_at}: choose another with --listen");
        let listener = TcpListener::bind(listen_at).await.with_context(taken)?;
        let (address, map) = (listener.local_addr()?, player.fleet.warehouse().clone());
        let recordings = Recordings::of_this_process();
        let kept = Folder::open(recordings.0.clone(), map.clone(), player.scenario.site.name.clone(), None);
        let kept = Arc::new(kept.with_context(|| format!("cannot write to {}", recordings.0.display()))?);
        let rotation = Rotation::new(kept.clone(), ALL);
        std::thread::Builder::new().name("ahead".into()).spawn(move || run_ahead(ahead, rotation))?;
        let (alarms, (moments, picture)) = (Arc::new(Alarms::default()), watch::channel(Arc::default()));
        let (ask, questions) = mpsc::channel(QUESTIONS);
        let (clock, arm) = (Clock::start(None), player.fleet.settings().policy.word());
        let live = Arc::new(Live::new(map.clone(), clock.now().0.unsigned_abs()));
        // Current poses change nothing in the past: they are dropped.
        let (feeds, past) = (Arc::new(Feeds::new().0), Arc::new(PastLists::default()));
        let figures = Arc::new(SharedHistory::new(Time::ZERO, arm, History::default()));
        let (closing, closes) = watch::channel(false);
        let api = Api {
            map,
            kind_checks: KindChecks::default(),
            moments: picture,
            records: past.clone(),
            figures: figures.clone(),
            queue: None,
            hooks: None,
            questions: ask,
            link: None,
            alarms: alarms.clone(),
            past: Some(kept),
            live: live.clone(),
            feeds: feeds.clone(),
            pseudonyms: Arc::default(),
            interop: Arc::new(Interop::default()),
            now: Arc::new(move || clock.now()),
            metrics: Arc::default(),
            trials: super::trial::trials(),
            maps: MapPort::default(),
            gate: Arc::new(Gate::default()),
            oidc: None,
            tokens: None,
            answers: None,
            audit: Arc::new(AuditLog::new(0).0),
            caller: Arc::new(Caller::this_machine()),
            entry: None,
            closing: closes.clone(),
        };
        let http = tokio::spawn(listen((listener, None), router(api).0, closes));
        let (measure, ahead, watch) = (Measure::default(), LastForecasts::default(), FloorWatch::default());
        let screen = Screen {
            live,
            feeds,
            alarms,
            moments,
            past,
            figures,
            watch,
            looked: None,
            ahead,
            measure,
            speed,
            questions,
        };
        let play = Some(tokio::spawn(screen.play(player)));
        Ok(Show { address, http, play, _closing: closing, _reels: recordings })
    }

    /// The address on which the show listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Plays to the end and stays on the last frame; returns only if an error occurs.
    ///
    /// # Errors
    /// If the recording cannot be read to its end.
    pub async fn ended(&mut self) -> anyhow::Result<()> {
        if let Some(play) = self.play.take() {
            play.await.context("the replay failed")??;
        }
        (&mut self.http).await.context("the HTTP server failed")??;
        Ok(())
    }
}

/// Plays a whole recording into a folder, as fast as possible.
fn run_ahead(mut player: Player, mut rotation: Rotation) {
    let mut record = FrameRecorder::default();
    // If the recording cannot be read any further, the other player reports it.
    while let Ok(Turn::Step(now, step)) = player.turn() {
        step.facts.iter().for_each(|fact| rotation.note(fact));
        if let Some(Err(e)) = record.take_frame(&player.fleet, now).map(|frame| rotation.take(&frame)) {
            return tracing::error!("cannot seek in the rest of the recording: {e}");
        }
    }
    if let Err(e) = rotation.finish() {
        tracing::error!("cannot seek to the end of the recording: {e}");
    }
}

/// What a recording is shown with: feed, alarms, figures.
struct Screen {
    live: Arc<Live>,
    feeds: Arc<Feeds>,
    alarms: Arc<Alarms>,
    moments: watch::Sender<Arc<Moment>>,
    past: Arc<PastLists>,
    figures: Arc<SharedHistory>,
    watch: FloorWatch,
    /// When the floor was last checked for alarms.
    looked: Option<Time>,
    ahead: LastForecasts,
    measure: Measure,
    speed: f64,
    questions: mpsc::Receiver<Question>,
}

impl Screen {
    async fn play(mut self, mut player: Player) -> anyhow::Result<()> {
        let mut published = Time(i64::MIN / 2);
        let began = tokio::time::Instant::now();
        let mut first = None;
        loop {
            match player.turn()? {
                Turn::Step(now, step) => {
                    let zero = *first.get_or_insert(now);
                    let due = Duration::from_secs_f64((now - zero).as_secs_f64() / self.speed);
                    tokio::time::sleep_until(began + due).await;
                    while let Ok(question) = self.questions.try_recv() {
                        question.answer(&player.fleet, now);
                    }
                    self.past.add(&step.facts, now);
                    if (now - published).as_secs_f64() >= PUBLISH.as_secs_f64() * self.speed.max(1.0) {
                        published = now;
                        self.publish(&player, now);
                    }
                }
                Turn::End { same } => {
                    self.publish(&player, published);
                    return self.stay(&player.fleet, same, published).await;
                }
            }
        }
    }

    fn publish(&mut self, player: &Player, now: Time) {
        let view = player.fleet.view(now);
        // The durations of searches are in no recording.
        self.figures.note(&view, &LoopTimes::default());
        self.feeds.know(&player.fleet.ledger().workers);
        self.feeds.refresh(&view, player.fleet.warehouse());
        self.note_alarms(&player.fleet, &view);
        let measured = self.measure.figures(now, view.counts.robot_deliveries);
        let forecasts = self.ahead.of(&player.fleet, now);
        let (time_s, backlog) = (now.as_secs_f64(), Arc::default());
        let moment = Arc::new(Moment {
            view,
            unheard: Some(0),
            time_s,
            simulation: None,
            measured,
            forecasts,
            backlog,
        });
        self.live.publish(&moment, &self.alarms.list(), 0.0);
        self.moments.send_replace(moment);
    }

    /// The alarms of the recording, except those about the recorded server, which is not in the recording.
    fn note_alarms(&mut self, fleet: &Fleet, view: &View) {
        self.alarms.note(view);
        if self.looked.is_none_or(|at| view.now - at >= LOOKS) {
            self.looked = Some(view.now);
            self.alarms.observe(self.watch.look(fleet, view, &LoopHealth::default()), view.now);
        }
    }

    /// Stays on the last frame; the feed goes on, so that no page takes the connection for lost.
    async fn stay(&mut self, fleet: &Fleet, same: bool, now: Time) -> anyhow::Result<()> {
        let told = if same { sentence::recording_ended() } else { sentence::recording_ended_otherwise() };
        self.alarms.raise(AlarmKind::RecordingEnded, told, now);
        loop {
            let moment = self.moments.borrow().clone();
            self.live.publish(&moment, &self.alarms.list(), 0.0);
            let second = tokio::time::timeout(Duration::from_secs(1), self.questions.recv());
            if let Ok(Some(question)) = second.await {
                question.answer(fleet, now);
            }
        }
    }
}
