-- SPDX-License-Identifier: GPL-3.0-or-later
-- The groups that a job's owner had when submitting, stored once for all jobs with the same ones.
-- NULL in jobs: not known (jobs of version 1, and files of the watch folder, which belong to the
-- service).

CREATE TABLE credentials(
 id INTEGER PRIMARY KEY,
 gid INTEGER NOT NULL,
 supplementary TEXT NOT NULL,
 uses INTEGER NOT NULL DEFAULT 0,
 UNIQUE (gid, supplementary)
) STRICT;

-- No foreign key: deleting credentials would search all jobs.
ALTER TABLE jobs ADD COLUMN credentials INTEGER;

CREATE TRIGGER credentials_used AFTER INSERT ON jobs WHEN NEW.credentials IS NOT NULL BEGIN
 UPDATE credentials SET uses = uses + 1 WHERE id = NEW.credentials;
 END;
CREATE TRIGGER credentials_left AFTER DELETE ON jobs WHEN OLD.credentials IS NOT NULL BEGIN
 UPDATE credentials SET uses = uses - 1 WHERE id = OLD.credentials;
 DELETE FROM credentials WHERE id = OLD.credentials AND uses = 0;
 END;
