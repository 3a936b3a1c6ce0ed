//! The workbench of umbmark: a page in the browser on which a model is compared with measurements, changed, fitted and learnt.
//!
//! [`Workbench::serve`] answers on loopback only, and only pages that it sent itself: every address has a random token in it, and the names of the
//! host and of the asking page are checked. Every number is computed by the functions that the verbs of the command call. All of a user's
//! work is one JSON document ([`State`]), which is written beside the data.

mod act;
mod app;
mod bench;
mod cloud;
mod dropped;
mod guard;
mod job;
mod later;
mod page;
mod server;
mod state;
mod typed;
mod words;

use std::net::{Ipv4Addr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use umbmark_core::action::Wording;
use umbmark_core::diagnose;
use umbmark_io::Topics;

pub use bench::Trouble;
pub use state::{Draft, Errors, Held, State, StateError, Step};

/// What is served.
#[derive(Clone, Debug)]
pub struct Served {
    /// The dataset to begin with; none where the page asks for it.
    pub place: Option<PathBuf>,
    /// The topics of its logs.
    pub topics: Topics,
    /// The folder into which files are written that are dropped on the page; it is made when the first one comes.
    pub drops: PathBuf,
    /// How models are tested.
    pub options: diagnose::Options,
    /// The port; 0 for any that is free.
    pub port: u16,
    /// The threads to compute on; 0 for all processors.
    pub threads: usize,
    /// What the program that serves it calls its actions.
    pub actions: Wording,
}

/// Why nothing is served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The port cannot be had.
    #[error("port {port} of 127.0.0.1 cannot be used: {error}; choose another port, or 0 for any that is free")]
    Port {
        /// The port.
        port: u16,
        /// Why.
        error: std::io::Error,
    },
    /// The system gives no random numbers for the token.
    #[error("the system gives no random numbers: {0}")]
    Random(String),
    /// The system gives no threads or sockets.
    #[error("the server cannot be started: {0}")]
    System(std::io::Error),
    /// The dataset cannot be opened.
    #[error(transparent)]
    Data(#[from] Trouble),
}

/// A server that is ready to answer.
#[derive(Debug)]
pub struct Workbench {
    app: Arc<app::App>,
    listener: TcpListener,
}

impl Workbench {
    /// Reads the dataset and takes the port.
    pub fn open(served: Served) -> Result<Workbench, ServeError> {
        let port = served.port;
        let listener =
            TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|error| ServeError::Port { port, error })?;
        let port = listener.local_addr().map_err(ServeError::System)?.port();
        let guard = guard::Guard::new(port).map_err(|error| ServeError::Random(error.to_string()))?;
        let app = Arc::new(app::App::new(served, guard)?);
        Ok(Workbench { app, listener })
    }

    /// The address of the page, with its token.
    pub fn address(&self) -> String {
        self.app.guard.address()
    }

    /// Answers until `stop` is set.
    pub fn serve(self, stop: &AtomicBool) -> Result<(), ServeError> {
        server::serve(&self.app, self.listener, stop).map_err(ServeError::System)
    }
}
