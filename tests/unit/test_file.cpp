// Files as a whole: what was written is read, and a write that fails leaves what was there.
#include "base/file.h"

#include <dirent.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <thread>
#include <vector>

#include "base/status.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

using Bytes = std::vector<uint8_t>;

std::string folder;

int make_folder(void **) {
    char name[] = "/tmp/packcell-file-XXXXXX";
    if (mkdtemp(name) == nullptr) return -1;
    folder = name;
    return 0;
}

std::vector<std::string> names_in_folder() {
    std::vector<std::string> names;
    DIR *const dir = opendir(folder.c_str());
    assert_non_null(dir);
    while (const dirent *entry = readdir(dir)) {
        const std::string name = entry->d_name;
        if (name != "." && name != "..") names.push_back(name);
    }
    closedir(dir);
    return names;
}

int empty_folder(void **) {
    for (const std::string &name : names_in_folder()) unlink((folder + "/" + name).c_str());
    return 0;
}

int remove_folder(void **) { return rmdir(folder.c_str()); }

Bytes some_bytes(size_t size, unsigned seed) {
    Bytes bytes(size);
    for (size_t i = 0; i < size; ++i)
        bytes[i] = static_cast<uint8_t>((i + seed) * 2654435761u >> 9);
    return bytes;
}

template <class Call>
std::string failure(Status status, Call call) {
    try {
        call();
    } catch (const Error &e) {
        assert_int_equal(static_cast<int>(e.status()), static_cast<int>(status));
        return e.what();
    }
    return "nothing failed";
}

void what_is_written_is_read_and_replaces_what_was_there(void **) {
    const std::string path = folder + "/a";
    for (const size_t size : {5u, 0u, 65535u, 65536u, 65537u, 1000000u, 3u}) {
        const Bytes bytes = some_bytes(size, static_cast<unsigned>(size));
        write_file(path.c_str(), bytes.data(), bytes.size());
        assert_true(read_file(path.c_str(), 1000000) == bytes);
        assert_int_equal(names_in_folder().size(), 1);
    }
}

void a_file_longer_than_the_limit_is_refused(void **) {
    const std::string path = folder + "/a";
    const Bytes bytes = some_bytes(100000, 1);
    write_file(path.c_str(), bytes.data(), bytes.size());
    assert_true(read_file(path.c_str(), 100000) == bytes);
    for (const size_t most : {0u, 1u, 65536u, 99999u}) {
        assert_string_equal(
            failure(Status::kFormat, [&] { read_file(path.c_str(), most); }).c_str(),
            (path + ": the file has more than " + std::to_string(most) + " bytes").c_str());
    }
    // One without an end and without a size.
    assert_string_equal(failure(Status::kFormat, [] { read_file("/dev/zero", 70000); }).c_str(),
                        "/dev/zero: the file has more than 70000 bytes");
}

void a_file_that_is_not_there_is_named(void **) {
    const std::string path = folder + "/none";
    assert_string_equal(failure(Status::kIo, [&] { read_file(path.c_str(), 1); }).c_str(),
                        (path + ": cannot be read: No such file or directory").c_str());
    assert_string_equal(failure(Status::kIo, [&] { read_file(folder.c_str(), 1); }).c_str(),
                        (folder + ": cannot be read: Is a directory").c_str());
    const std::string deep = path + "/deep";
    assert_string_equal(failure(Status::kIo, [&] { write_file(deep.c_str(), nullptr, 0); }).c_str(),
                        (deep + ": cannot be written: No such file or directory").c_str());
    const std::string longest = folder + "/" + std::string(5000, 'x');
    const std::string text = failure(Status::kIo, [&] { read_file(longest.c_str(), 1); });
    assert_int_equal(text.find("..."), 0);
    assert_true(text.find("xxx: cannot be read: File name too long") != std::string::npos);
}

void a_write_that_fails_leaves_the_old_file_and_no_other(void **) {
    const std::string path = folder + "/a";
    const Bytes old = some_bytes(3000, 1);
    const Bytes bytes = some_bytes(300000, 2);
    write_file(path.c_str(), old.data(), old.size());
    // The disk is full after 100000 bytes.
    rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    rlimit small = before;
    small.rlim_cur = 100000;
    const auto handler = signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string text =
        failure(Status::kIo, [&] { write_file(path.c_str(), bytes.data(), bytes.size()); });
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, handler);
    assert_string_equal(text.c_str(), (path + ": cannot be written: File too large").c_str());
    assert_true(read_file(path.c_str(), 5000) == old);
    assert_int_equal(names_in_folder().size(), 1);
}

void a_folder_is_not_replaced(void **) {
    const std::string path = folder + "/sub";
    assert_int_equal(mkdir(path.c_str(), 0777), 0);
    assert_string_equal(failure(Status::kIo, [&] { write_file(path.c_str(), nullptr, 0); }).c_str(),
                        (path + ": cannot be written: Is a directory").c_str());
    assert_int_equal(names_in_folder().size(), 1);
    assert_int_equal(rmdir(path.c_str()), 0);
}

// A crash leaves a file by such a name; it is in nobody's way.
void left_overs_of_a_crash_do_not_hinder(void **) {
    const std::string path = folder + "/a";
    const std::string left = path + "." + std::to_string(getpid()) + ".0.tmp";
    const Bytes bytes = some_bytes(10, 1);
    write_file(left.c_str(), bytes.data(), bytes.size());
    write_file(path.c_str(), bytes.data(), bytes.size());
    assert_true(read_file(path.c_str(), 10) == bytes);
}

void threads_that_write_one_file_leave_it_whole(void **) {
    const std::string path = folder + "/a";
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < 4; ++t) {
        threads.emplace_back([&path, t] {
            const Bytes bytes = some_bytes(20000, t);
            for (int i = 0; i < 10; ++i) write_file(path.c_str(), bytes.data(), bytes.size());
        });
    }
    for (std::thread &thread : threads) thread.join();
    const Bytes bytes = read_file(path.c_str(), 20000);
    bool whole = false;
    for (unsigned t = 0; t < 4; ++t) whole = whole || bytes == some_bytes(20000, t);
    assert_true(whole);
    assert_int_equal(names_in_folder().size(), 1);
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test_teardown(what_is_written_is_read_and_replaces_what_was_there,
                                  empty_folder),
        cmocka_unit_test_teardown(a_file_longer_than_the_limit_is_refused, empty_folder),
        cmocka_unit_test_teardown(a_file_that_is_not_there_is_named, empty_folder),
        cmocka_unit_test_teardown(a_write_that_fails_leaves_the_old_file_and_no_other,
                                  empty_folder),
        cmocka_unit_test_teardown(a_folder_is_not_replaced, empty_folder),
        cmocka_unit_test_teardown(left_overs_of_a_crash_do_not_hinder, empty_folder),
        cmocka_unit_test_teardown(threads_that_write_one_file_leave_it_whole, empty_folder),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
