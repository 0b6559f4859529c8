-- SPDX-License-Identifier: GPL-3.0-or-later
-- The noise level, the stamp that counts most, and a seventh number in a stamp's terms.

-- Null: not known, as for all contributions of older versions. The index finds a field's largest
-- value, and whether one is null.
ALTER TABLE contributions ADD COLUMN top_size REAL;
ALTER TABLE contributions ADD COLUMN top_stamp INTEGER;
CREATE INDEX contributions_top ON contributions(field, top_size DESC, top_stamp);

-- The size of a stamp's terms in the row. Old rows are not converted: there may be gigabytes of
-- them.
ALTER TABLE contribution_terms ADD COLUMN stamp_bytes INTEGER NOT NULL DEFAULT 48;

-- A job that resumed from sums without noise parts would have a wrong noise level: jobs that were
-- stopped begin again.
DELETE FROM checkpoint_terms;
DELETE FROM checkpoints;
