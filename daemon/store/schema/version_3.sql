-- SPDX-License-Identifier: GPL-3.0-or-later
-- The terms of stamps for estimators that need them (shear_symmetry_bytes): of a checkpoint in
-- pieces that end before a block, of a contribution in parts of bounded size.

CREATE TABLE checkpoint_terms(
 job INTEGER NOT NULL REFERENCES checkpoints(job) ON DELETE CASCADE,
 end_block INTEGER NOT NULL,
 bytes BLOB NOT NULL,
 UNIQUE (job, end_block)
) STRICT;

CREATE TABLE contribution_terms(
 contribution INTEGER NOT NULL REFERENCES contributions(id),
 part INTEGER NOT NULL,
 bytes BLOB NOT NULL,
 UNIQUE (contribution, part)
) STRICT;
