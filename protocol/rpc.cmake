# SPDX-License-Identifier: GPL-3.0-or-later
# The wire protocol of the service: framing, JSON-RPC, messages (docs/protocol.md).
target_sources(shear_protocol PRIVATE
  frame.c
  msg_fields.c msg_job.c msg_names.c msg_read.c msg_read_value.c msg_request.c msg_service.c
  msg_settings.c msg_time.c msg_value.c msg_write.c
  rpc_codes.c rpc_dump.c rpc_envelope.c rpc_files.c rpc_lines.c rpc_lists.c rpc_load.c rpc_message.c rpc_methods.c
  rpc_request.c rpc_scan.c)
