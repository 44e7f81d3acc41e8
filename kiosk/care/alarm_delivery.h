// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/result.h"
#include "kiosk/care/care_settings.h"

namespace cyclorama::care {

/// Sends a message by SMTP (RFC 5321), with TLS as the settings require it. Blocks for at most a minute. Errors, each with
/// the server and a remedy: kUnavailable if the server cannot be reached or its certificate is not trusted;
/// kInvalidArgument if it refuses the login or an address; those of read_secret().
Status send_mail(const MailSettings& mail, const std::string& message);

/// Sends JSON by POST. Redirects are not followed. Blocks for at most a minute. Errors: kUnavailable if the server cannot
/// be reached, or answers with a status other than 2xx; those of read_secret().
Status send_webhook(const WebhookSettings& webhook, const std::string& json);

}  // namespace cyclorama::care
