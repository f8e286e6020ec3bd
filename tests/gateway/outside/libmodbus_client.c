/* A client of the gateway over libmodbus: reads the identity registers, sends one item, and prints
 * what it saw as a line of JSON. Usage: libmodbus_client PORT ABCD|CDAB ITEM */
#include <errno.h>
#include <modbus.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kCommandWords = 48, kStatus = 200, kAck = 207, kIdentity = 1000, kIdentityWords = 16 };

static modbus_t *client;

static void need(int holds, const char *what) {
    if (holds) return;
    fprintf(stderr, "libmodbus_client: %s: %s\n", what, modbus_strerror(errno));
    exit(1);
}

/* That the request was refused by this Modbus exception. */
static void refused(int answer, int exception, const char *what) {
    need(answer < 0 && errno == MODBUS_ENOBASE + exception, what);
}

static void send_item(uint32_t item, int high_first) {
    uint16_t block[kCommandWords] = {0};
    uint16_t ack = 0;
    uint16_t both[2];
    need(modbus_read_registers(client, kAck, 1, &ack) == 1, "ack_seq");
    const uint16_t number = (uint16_t)(ack % 65535 + 1);
    block[0] = block[kCommandWords - 1] = number;
    block[1] = 1; /* ITEM_ARRIVED */
    block[high_first ? 3 : 4] = (uint16_t)(item >> 16);
    block[high_first ? 4 : 3] = (uint16_t)(item & 0xFFFF);
    block[5] = 2;
    block[6] = 3;
    /* Written and read at once, by function code 23. */
    need(modbus_write_and_read_registers(client, 0, kCommandWords, block, kAck, 2, both) == 2,
         "ITEM_ARRIVED");
    need(both[0] == number && both[1] == number, "ack_seq and done_seq after ITEM_ARRIVED");
}

int main(int argc, char **argv) {
    uint16_t words[kIdentityWords];
    uint16_t mirror[kIdentityWords];
    uint16_t status[3];
    uint8_t bit = 0;
    if (argc != 4) {
        fprintf(stderr, "usage: libmodbus_client PORT ABCD|CDAB ITEM\n");
        return 2;
    }
    const int high_first = strcmp(argv[2], "ABCD") == 0;
    client = modbus_new_tcp("127.0.0.1", atoi(argv[1]));
    need(client != NULL && modbus_connect(client) == 0, "connection");
    need(modbus_set_response_timeout(client, 30, 0) == 0, "timeout");
    need(modbus_read_registers(client, kIdentity, kIdentityWords, words) == kIdentityWords,
         "identity");
    need(modbus_read_input_registers(client, kIdentity, kIdentityWords, mirror) == kIdentityWords,
         "identity by function code 4");
    need(memcmp(words, mirror, sizeof words) == 0, "function code 4 reads the same");
    need(modbus_read_registers(client, kStatus, 3, status) == 3, "status");
    refused(modbus_read_bits(client, 0, 1, &bit), 1, "coils must give exception 1");
    refused(modbus_read_registers(client, 150, 1, words), 2, "register 150 must give exception 2");
    refused(modbus_read_registers(client, 230, 4, words), 2, "230..233 must give exception 2");
    refused(modbus_write_register(client, kStatus, 1), 2, "a write to 200 must give exception 2");
    refused(modbus_write_registers(client, 95, 20, words), 2, "95..114 must give exception 2");
    need(modbus_write_register(client, 96, 7) == 1, "heartbeat by function code 6");
    send_item((uint32_t)strtoul(argv[3], NULL, 10), high_first);
    /* libmodbus has no signed 32-bit getter for these orders: the words say it. */
    const uint16_t high = words[high_first ? 4 : 5];
    const uint16_t low = words[high_first ? 5 : 4];
    const double number = high_first ? (double)modbus_get_float_abcd(words + 6)
                                     : (double)modbus_get_float_cdab(words + 6);
    printf(
        "{\"version\": [%d, %d, %d], \"whole\": %d, \"number\": %.3f, \"status\": [%d, %d, %d]}\n",
        words[0], words[1], words[2], (int)((uint32_t)high << 16 | low), number, status[0],
        status[1], status[2]);
    modbus_close(client);
    modbus_free(client);
    return 0;
}
