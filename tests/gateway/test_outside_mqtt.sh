#!/usr/bin/env bash
# What an MES sees: the last will after kill -9, retained topics, every event in order whatever breaks,
# job orders answered; and a broker that is away or refuses stops nothing.
here=$(dirname "$0")
# shellcheck source=tests/gateway/outside/common.sh
source "$here/outside/common.sh" "$@"
need mosquitto mosquitto_pub mosquitto_sub mosquitto_passwd
exec "$python" "$here/outside/mqtt_check.py" "$gateway"
