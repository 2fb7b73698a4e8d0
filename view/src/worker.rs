//! A studio on a thread of its own: the window says what it wishes, and never waits.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use eframe::egui;

use crate::news::{Answer, Ask, Doing, News, Picture};
use crate::studio::{Step, Studio};
use crate::wish::Wish;

/// What window and studio leave for each other.
#[derive(Default)]
struct Post {
    wish: Option<Wish>,
    /// Has the studio not seen it yet?
    is_new: bool,
    has_quit: bool,
    news: News,
    /// One that the window has not taken yet.
    picture: Option<Picture>,
    asks: VecDeque<Ask>,
    answers: VecDeque<Answer>,
}

#[derive(Default)]
struct Mailbox {
    post: Mutex<Post>,
    changed: Condvar,
}

impl Mailbox {
    fn open(&self) -> MutexGuard<'_, Post> {
        self.post.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Calls for another frame of a window, from any thread.
pub(crate) fn repaint(context: &egui::Context) -> impl Fn() + Clone + Send + Sync + 'static {
    let context = context.clone();
    move || context.request_repaint()
}

/// A thread that makes pictures.
pub struct Worker {
    mailbox: Arc<Mailbox>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts one. `repaint` is called whenever there is something to be seen.
    pub fn new(studio: Studio, repaint: impl Fn() + Send + Sync + 'static) -> Worker {
        let mailbox = Arc::new(Mailbox::default());
        let own = mailbox.clone();
        let work = move || {
            if catch_unwind(AssertUnwindSafe(|| work(studio, &own, &repaint))).is_err() {
                let fault = "the renderer has failed, which is a fault of this program: please report it, with what standard error says";
                own.open().news = News { doing: Doing::Nothing, fault: Some(fault.to_owned()), ..News::default() };
                repaint();
            }
        };
        Worker { mailbox, thread: Some(thread::spawn(work)) }
    }

    /// Says what is wished for from now on.
    pub fn wish(&self, wish: &Wish) {
        let mut post = self.mailbox.open();
        (post.wish, post.is_new) = (Some(wish.clone()), true);
        self.mailbox.changed.notify_one();
    }

    /// Asks something of the picture.
    pub fn ask(&self, ask: Ask) {
        self.mailbox.open().asks.push_back(ask);
        self.mailbox.changed.notify_one();
    }

    /// What was asked for, once it is known, one after the other.
    pub fn answer(&self) -> Option<Answer> {
        self.mailbox.open().answers.pop_front()
    }

    /// Where the studio stands, and a picture that is newer than the last that was taken.
    pub fn take(&self) -> (News, Option<Picture>) {
        let mut post = self.mailbox.open();
        (post.news.clone(), post.picture.take())
    }
}

impl Drop for Worker {
    /// Waits until the step that is under way is done: a driver must not be at work for a process that ends.
    fn drop(&mut self) {
        self.mailbox.open().has_quit = true;
        self.mailbox.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn work(mut studio: Studio, mailbox: &Mailbox, repaint: &dyn Fn()) {
    let mut goes_on = false;
    while let Some((wish, ask)) = next(mailbox, goes_on) {
        let told = |news: &News| {
            mailbox.open().news = news.clone();
            repaint();
        };
        let Step { picture, goes_on: more } = studio.step(&wish, &told);
        goes_on = more;
        let is_news = picture.is_some() || !goes_on || ask.is_some();
        if let Some(ask) = ask {
            let answer = studio.answer(&wish, ask);
            mailbox.open().answers.push_back(answer);
        }
        let mut post = mailbox.open();
        post.news = studio.news().clone();
        post.picture = picture.or(post.picture.take());
        drop(post);
        if is_news {
            repaint();
        }
    }
}

/// The wish to go on with, and what was asked of its picture, where there is something to do; none at the end.
fn next(mailbox: &Mailbox, goes_on: bool) -> Option<(Wish, Option<Ask>)> {
    let mut post = mailbox.open();
    loop {
        if post.has_quit {
            return None;
        }
        if post.is_new || goes_on || !post.asks.is_empty() {
            post.is_new = false;
            let ask = post.asks.pop_front();
            if let Some(wish) = &post.wish {
                return Some((wish.clone(), ask));
            }
        }
        post = mailbox.changed.wait(post).unwrap_or_else(PoisonError::into_inner);
    }
}
