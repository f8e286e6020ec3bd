// Serves the operator page with the states that come on standard input, one JSON a line, and ends
// with its input. Prints the port, and at the end how long that took.
//
// usage: page_server [HOST:PORT [ADDRESS]], ADDRESS being that of the one client from elsewhere
#include "gateway/page/http_page.hpp"

#include <arpa/inet.h>

#include <chrono>
#include <iostream>
#include <string>

#include "common/errors.hpp"

using namespace packcell_programs;

int main(int argc, char **argv) {
    return run_program("page_server", [&] {
        HttpPage::AllowedPeer allowed;
        if (argc > 2) {
            const uint32_t guest = ntohl(inet_addr(argv[2]));
            allowed = [guest](uint32_t address) { return address == guest; };
        }
        HttpPage page(argc > 1 ? argv[1] : "127.0.0.1:0", allowed);
        std::cout << page.port() << std::endl;
        for (std::string line; std::getline(std::cin, line);) page.publish(line);
        const auto start = std::chrono::steady_clock::now();
        page.stop();
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        std::cout << took.count() << std::endl;
        return kExitDone;
    });
}
