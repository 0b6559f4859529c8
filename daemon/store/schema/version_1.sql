-- SPDX-License-Identifier: GPL-3.0-or-later
-- The numbers for state, outcome, origin, class and ending are those of codes.h.
--
-- No statement may cost more because more jobs have finished: what is read often has an index that
-- holds only the few rows concerned (queue, waiting, pending), and what would have to be counted is
-- stored (counts, totals).

-- uses: number of jobs and fields that refer to it
CREATE TABLE settings(
 digest TEXT NOT NULL PRIMARY KEY,
 text TEXT NOT NULL,
 uses INTEGER NOT NULL DEFAULT 0
) STRICT, WITHOUT ROWID;

-- AUTOINCREMENT: the id of a retired job is not used again.
CREATE TABLE jobs(
 id INTEGER PRIMARY KEY AUTOINCREMENT,
 state INTEGER NOT NULL DEFAULT 0 CHECK (state BETWEEN 0 AND 5),
 outcome INTEGER NOT NULL DEFAULT 0,
 origin INTEGER NOT NULL,
 priority INTEGER NOT NULL,
 forced INTEGER NOT NULL,
 cancel_asked INTEGER NOT NULL DEFAULT 0,
 owner INTEGER NOT NULL,
 attempts INTEGER NOT NULL DEFAULT 0,
 failures INTEGER NOT NULL DEFAULT 0,
 interrupted INTEGER NOT NULL DEFAULT 0,
 attempt INTEGER NOT NULL DEFAULT 0,
 created_ms INTEGER NOT NULL,
 started_ms INTEGER NOT NULL DEFAULT 0,
 finished_ms INTEGER NOT NULL DEFAULT 0,
 not_before_ms INTEGER NOT NULL DEFAULT 0,
 n_stamps INTEGER NOT NULL DEFAULT -1,
 n_used INTEGER NOT NULL DEFAULT -1,
 elapsed_us INTEGER NOT NULL DEFAULT 0,
 duplicate_of INTEGER NOT NULL DEFAULT 0,
 failure_class INTEGER NOT NULL DEFAULT 0,
 field TEXT, -- requested, or from the file
 field_asked TEXT,
 source TEXT NOT NULL,
 settings TEXT NOT NULL, -- digest
 idempotency_key TEXT,
 content TEXT,
 code TEXT,
 message TEXT,
 advice TEXT,
 result TEXT,
 catalogue TEXT
) STRICT;

-- For pages: each index ends in the id.
CREATE INDEX jobs_state ON jobs(state);
CREATE INDEX jobs_owner ON jobs(owner, state);
CREATE INDEX jobs_field ON jobs(field, state);
CREATE INDEX jobs_owner_field ON jobs(owner, field, state);
CREATE UNIQUE INDEX jobs_key ON jobs(owner, idempotency_key)
 WHERE idempotency_key IS NOT NULL;
CREATE INDEX jobs_queue ON jobs(priority DESC, id) WHERE state = 0;
CREATE INDEX jobs_waiting ON jobs(not_before_ms) WHERE state = 2;
CREATE INDEX jobs_pending ON jobs(field, settings) WHERE state < 3;
CREATE INDEX jobs_finished ON jobs(finished_ms) WHERE state >= 3;

CREATE TABLE attempts(
 job INTEGER NOT NULL REFERENCES jobs(id) ON DELETE CASCADE,
 number INTEGER NOT NULL,
 started_ms INTEGER NOT NULL,
 ended_ms INTEGER NOT NULL DEFAULT 0,
 ending INTEGER NOT NULL DEFAULT 0,
 failure_class INTEGER NOT NULL DEFAULT 0,
 code TEXT,
 message TEXT,
 PRIMARY KEY (job, number)
) STRICT, WITHOUT ROWID;

CREATE TABLE checkpoints(
 job INTEGER PRIMARY KEY REFERENCES jobs(id) ON DELETE CASCADE,
 next_block INTEGER NOT NULL,
 sums TEXT NOT NULL
) STRICT;

CREATE TABLE fields(
 id INTEGER PRIMARY KEY,
 name TEXT NOT NULL,
 settings TEXT NOT NULL, -- digest
 jobs INTEGER NOT NULL,
 n_stamps INTEGER NOT NULL,
 n_used INTEGER NOT NULL,
 updated_ms INTEGER NOT NULL,
 sums TEXT NOT NULL,
 UNIQUE (name, settings)
) STRICT;

-- Outlives its job, so that a duplicate is recognised after the job was retired: no foreign key. A
-- forced job may have the identity of another one. A job has at most one row.
CREATE TABLE contributions(
 id INTEGER PRIMARY KEY,
 field INTEGER NOT NULL REFERENCES fields(id),
 job INTEGER NOT NULL UNIQUE,
 content TEXT NOT NULL,
 n_stamps INTEGER NOT NULL,
 n_used INTEGER NOT NULL,
 counted_ms INTEGER NOT NULL,
 sums TEXT NOT NULL
) STRICT;

CREATE INDEX contributions_identity ON contributions(field, content);
CREATE INDEX contributions_order ON contributions(field);

CREATE TABLE counts(state INTEGER PRIMARY KEY, n INTEGER NOT NULL CHECK (n >= 0)) STRICT;
INSERT INTO counts VALUES (0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0);

CREATE TABLE totals(
 id INTEGER PRIMARY KEY CHECK (id = 1),
 submitted INTEGER NOT NULL DEFAULT 0,
 counted INTEGER NOT NULL DEFAULT 0,
 duplicates INTEGER NOT NULL DEFAULT 0,
 failed INTEGER NOT NULL DEFAULT 0,
 cancelled INTEGER NOT NULL DEFAULT 0,
 retired INTEGER NOT NULL DEFAULT 0,
 attempts INTEGER NOT NULL DEFAULT 0,
 interrupted INTEGER NOT NULL DEFAULT 0,
 failures_transient INTEGER NOT NULL DEFAULT 0,
 failures_data INTEGER NOT NULL DEFAULT 0,
 failures_bug INTEGER NOT NULL DEFAULT 0,
 n_stamps INTEGER NOT NULL DEFAULT 0,
 n_used INTEGER NOT NULL DEFAULT 0,
 elapsed_us INTEGER NOT NULL DEFAULT 0,
 fields INTEGER NOT NULL DEFAULT 0
) STRICT;
INSERT INTO totals(id) VALUES (1);

-- Triggers, so that no change of a job can miss the numbers.
CREATE TRIGGER job_added AFTER INSERT ON jobs BEGIN
 UPDATE counts SET n = n + 1 WHERE state = NEW.state;
 UPDATE totals SET submitted = submitted + 1 WHERE id = 1;
 UPDATE settings SET uses = uses + 1 WHERE digest = NEW.settings;
 END;
CREATE TRIGGER job_moved AFTER UPDATE OF state ON jobs WHEN NEW.state <> OLD.state BEGIN
 UPDATE counts SET n = n - 1 WHERE state = OLD.state;
 UPDATE counts SET n = n + 1 WHERE state = NEW.state;
 END;
CREATE TRIGGER job_finished AFTER UPDATE OF state ON jobs
 WHEN NEW.state <> OLD.state AND NEW.state >= 3 BEGIN
 UPDATE totals SET
  counted = counted + (NEW.outcome = 1),
  duplicates = duplicates + (NEW.outcome = 2),
  failed = failed + (NEW.state = 4),
  cancelled = cancelled + (NEW.state = 5),
  n_stamps = n_stamps + iif(NEW.outcome = 1, NEW.n_stamps, 0),
  n_used = n_used + iif(NEW.outcome = 1, NEW.n_used, 0),
  elapsed_us = elapsed_us + NEW.elapsed_us
 WHERE id = 1;
 END;
CREATE TRIGGER job_retired AFTER DELETE ON jobs BEGIN
 UPDATE counts SET n = n - 1 WHERE state = OLD.state;
 UPDATE totals SET retired = retired + 1 WHERE id = 1;
 UPDATE settings SET uses = uses - 1 WHERE digest = OLD.settings;
 DELETE FROM settings WHERE digest = OLD.settings AND uses = 0;
 END;
CREATE TRIGGER attempt_opened AFTER INSERT ON attempts BEGIN
 UPDATE totals SET attempts = attempts + 1 WHERE id = 1;
 END;
CREATE TRIGGER attempt_closed AFTER UPDATE OF ending ON attempts BEGIN
 UPDATE totals SET
  interrupted = interrupted + (NEW.ending = 5),
  failures_transient = failures_transient + (NEW.failure_class = 1),
  failures_data = failures_data + (NEW.failure_class = 2),
  failures_bug = failures_bug + (NEW.failure_class = 3)
 WHERE id = 1;
 END;
CREATE TRIGGER field_added AFTER INSERT ON fields BEGIN
 UPDATE totals SET fields = fields + 1 WHERE id = 1;
 UPDATE settings SET uses = uses + 1 WHERE digest = NEW.settings;
 END;
