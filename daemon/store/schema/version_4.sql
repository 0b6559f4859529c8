-- SPDX-License-Identifier: GPL-3.0-or-later
-- Reports of fields, the reasons of waiting, dropped files, retracted jobs, the database's identity.

-- What the field's report needs; `account` is a text of the caller's. Older jobs that are still
-- kept have a result, from which it is taken.
ALTER TABLE contributions ADD COLUMN account TEXT;
ALTER TABLE contributions ADD COLUMN elapsed_us INTEGER NOT NULL DEFAULT 0;
ALTER TABLE contributions ADD COLUMN true_g1 REAL; -- null: not known
ALTER TABLE contributions ADD COLUMN true_g2 REAL;
ALTER TABLE fields ADD COLUMN elapsed_us INTEGER NOT NULL DEFAULT 0;
UPDATE contributions SET (account, elapsed_us, true_g1, true_g2) =
 (SELECT json_extract(result, '$.files[0]'), elapsed_us,
  json_extract(result, '$.truth.g1'), json_extract(result, '$.truth.g2')
  FROM jobs WHERE id = contributions.job)
 WHERE EXISTS (SELECT 1 FROM jobs WHERE id = contributions.job AND json_valid(result));
UPDATE fields SET elapsed_us = (SELECT coalesce(sum(elapsed_us), 0) FROM contributions
  INDEXED BY contributions_order WHERE field = fields.id);

-- The first and last entry of a field show whether all its truths are the same.
CREATE INDEX contributions_truth ON contributions(field, true_g1, true_g2);

CREATE TRIGGER contribution_added AFTER INSERT ON contributions BEGIN
 UPDATE fields SET elapsed_us = elapsed_us + NEW.elapsed_us WHERE id = NEW.field;
 END;
CREATE TRIGGER contribution_left AFTER DELETE ON contributions BEGIN
 UPDATE fields SET elapsed_us = elapsed_us - OLD.elapsed_us WHERE id = OLD.field;
 END;

-- Why jobs wait: read often, while there may be very many of them.
CREATE INDEX jobs_waiting_reason ON jobs(code, not_before_ms, attempts, state) WHERE state = 2;

-- Retracted jobs. A check cannot be altered, so its text is changed as SQLite's ALTER TABLE page
-- describes (it describes no bytes on disk).
PRAGMA writable_schema = ON;
UPDATE sqlite_schema SET sql = replace(sql, 'CHECK (state BETWEEN 0 AND 5)',
 'CHECK (state BETWEEN 0 AND 6)') WHERE type = 'table' AND name = 'jobs';
PRAGMA writable_schema = RESET;
INSERT INTO counts VALUES (6, 0);

-- Random and permanent: what belongs to the database but is outside it (catalogs) is marked with
-- it.
CREATE TABLE identity(id INTEGER PRIMARY KEY CHECK (id = 1), text TEXT NOT NULL) STRICT;
INSERT INTO identity VALUES (1, lower(hex(randomblob(16))));

-- dropped: name in incoming/. resting: where the file of a final job is ("failed/NAME");
-- resting_print: its fingerprint. NULL: not known, or no such file.
ALTER TABLE jobs ADD COLUMN dropped TEXT;
ALTER TABLE jobs ADD COLUMN resting TEXT;
ALTER TABLE jobs ADD COLUMN resting_print TEXT;
UPDATE jobs SET dropped = substr(old.path, instr(old.path, old.mark) + length(old.mark))
 FROM (SELECT id, '/active/' || idempotency_key || '-' AS mark,
  iif(json_valid(source), json_extract(source, '$.path'), NULL) AS path
  FROM jobs WHERE origin = 0) AS old
 WHERE jobs.id = old.id AND instr(old.path, old.mark) > 0;

ALTER TABLE totals ADD COLUMN retracted INTEGER NOT NULL DEFAULT 0;

-- catalogs of retracted jobs, until their files are removed
CREATE INDEX jobs_leftover ON jobs(id) WHERE state = 6 AND catalogue IS NOT NULL;

DROP TRIGGER job_finished;
CREATE TRIGGER job_finished AFTER UPDATE OF state ON jobs
 WHEN OLD.state < 3 AND NEW.state >= 3 BEGIN
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
CREATE TRIGGER contribution_removed BEFORE DELETE ON contributions BEGIN
 DELETE FROM contribution_terms WHERE contribution = OLD.id;
 UPDATE totals SET retracted = retracted + 1 WHERE id = 1;
 END;
CREATE TRIGGER field_removed AFTER DELETE ON fields BEGIN
 UPDATE totals SET fields = fields - 1 WHERE id = 1;
 UPDATE settings SET uses = uses - 1 WHERE digest = OLD.settings;
 DELETE FROM settings WHERE digest = OLD.settings AND uses = 0;
 END;
