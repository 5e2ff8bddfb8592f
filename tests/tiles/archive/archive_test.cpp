#include "tiles/archive/archive.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "tests/tiles/archive/temporary_folder.h"
#include "tiles/archive/hash_index.h"
#include "tiles/archive/zip_format.h"

namespace citystream::tiles::archive {
namespace {

using Bytes = std::vector<std::byte>;
using Entries = std::vector<std::pair<std::string, std::string>>;

const Entries kSmall = {{"tileset.json", "{\"asset\":{\"version\":\"1.1\"}}"},
                        {"tiles/3/1/2.mesh", "mesh bytes"},
                        {"tiles/3/1/2.atlas", std::string(70, '\0')},
                        {"x", "y"}};

Status write_archive(const std::string& path, const Entries& entries) {
    auto writer = ArchiveWriter::create(path);
    if (!writer) return writer.error();
    for (const auto& [name, text] : entries) {
        if (auto status = (*writer)->add(name, to_bytes(text)); !status) return status;
    }
    return (*writer)->finish();
}

Bytes small_archive() {
    const TemporaryFolder folder;
    EXPECT_TRUE(write_archive(folder / "a.3tz", kSmall).ok());
    return read_bytes(folder / "a.3tz");
}

std::string all_errors(const std::vector<Error>& errors) {
    std::string text;
    for (const Error& error : errors) text += error.text() + "\n";
    return text;
}

// What opening or verifying these bytes complains about; empty when nothing is wrong.
std::string complaints(const Bytes& bytes) {
    const auto reader = open_archive_bytes(bytes);
    return reader ? all_errors((*reader)->verify()) : reader.error().text();
}

void append(Bytes& to, const Bytes& from) {
    to.insert(to.end(), from.begin(), from.end());
}

TEST(Archive, GivesBackEveryEntryAndNothingElse) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_archive(folder / "a.3tz", kSmall).ok());
    const auto reader = ArchiveReader::open(folder / "a.3tz");
    ASSERT_TRUE(reader.ok()) << reader.error().text();
    ASSERT_EQ((*reader)->entries().size(), kSmall.size());
    for (size_t i = 0; i < kSmall.size(); ++i) {
        const auto found = (*reader)->find(kSmall[i].first);
        EXPECT_EQ(std::string(reinterpret_cast<const char*>(found.data()), found.size()), kSmall[i].second);
        EXPECT_EQ((*reader)->entries()[i].name, kSmall[i].first);
        EXPECT_EQ((*reader)->entries()[i].size, kSmall[i].second.size());
    }
    for (const char* absent : {"", "tiles", "tiles/3/1/2", "tileset.json ", "/tileset.json", "@3dtilesIndex1@"}) {
        EXPECT_EQ((*reader)->find(absent).data(), nullptr) << absent;
    }
    EXPECT_EQ(all_errors((*reader)->verify()), "");
    EXPECT_EQ((*reader)->file_size(), std::filesystem::file_size(folder / "a.3tz"));
}

TEST(Archive, SameEntriesGiveTheSameBytes) {
    EXPECT_EQ(small_archive(), small_archive());
}

TEST(Archive, EntriesWrittenInPiecesEqualEntriesWrittenAtOnce) {
    const TemporaryFolder folder;
    std::string large(3'500'000, '\0');
    for (size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>(i * 7 + i / 251);
    ASSERT_TRUE(write_archive(folder / "whole.3tz", {{"a", "first"}, {"large", large}, {"z", "last"}}).ok());
    auto writer = ArchiveWriter::create(folder / "pieces.3tz");
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE((*writer)->add("a", to_bytes("first")).ok());
    ASSERT_TRUE((*writer)->begin_entry("large").ok());
    for (size_t at = 0; at < large.size(); at += 70'001) {
        ASSERT_TRUE((*writer)->append(to_bytes(large.substr(at, 70'001))).ok());
    }
    ASSERT_TRUE((*writer)->end_entry().ok());
    ASSERT_TRUE((*writer)->add("z", to_bytes("last")).ok());
    ASSERT_TRUE((*writer)->finish().ok());
    EXPECT_EQ(read_bytes(folder / "whole.3tz"), read_bytes(folder / "pieces.3tz"));
    EXPECT_EQ(complaints(read_bytes(folder / "pieces.3tz")), "");
}

TEST(Archive, IndexIsSortedByTheHashAsTwoLittleEndianIntegers) {
    std::vector<ZipRecord> records;
    for (int i = 0; i < 500; ++i)
        records.push_back({"tiles/" + std::to_string(i), static_cast<uint64_t>(i) * 100, 1, 0});
    const Bytes index = build_index(records);
    ASSERT_EQ(index.size(), records.size() * 24);
    uint64_t before = 0;
    for (size_t i = 0; i < records.size(); ++i) {
        uint64_t first = 0;
        uint64_t offset = 0;
        std::memcpy(&first, index.data() + i * 24, 8);
        std::memcpy(&offset, index.data() + i * 24 + 16, 8);
        EXPECT_LE(before, first);
        before = first;
        unsigned char digest[EVP_MAX_MD_SIZE];
        const std::string& name = records[offset / 100].name;
        EVP_Digest(name.data(), name.size(), digest, nullptr, EVP_md5(), nullptr);
        EXPECT_EQ(std::memcmp(digest, index.data() + i * 24, 16), 0) << name;
    }
}

TEST(Archive, EveryFlippedBitIsFound) {
    Bytes bytes = small_archive();
    ASSERT_EQ(complaints(bytes), "");
    for (size_t i = 0; i < bytes.size(); ++i) {
        for (unsigned bit = 0; bit < 8; ++bit) {
            bytes[i] ^= static_cast<std::byte>(1U << bit);
            EXPECT_NE(complaints(bytes), "") << "byte " << i << " bit " << bit;
            bytes[i] ^= static_cast<std::byte>(1U << bit);
        }
    }
}

TEST(Archive, VerifyNamesTheDamagedEntry) {
    Bytes bytes = small_archive();
    const auto reader = open_archive_bytes(bytes);
    ASSERT_TRUE(reader.ok());
    const ArchiveEntry entry = (*reader)->entries()[1];
    bytes[entry.data_offset + 3] ^= std::byte{4};
    const auto errors = (*reader)->verify();
    ASSERT_EQ(errors.size(), 1U);
    EXPECT_NE(errors[0].message.find("tiles/3/1/2.mesh: contents damaged (CRC-32 "), std::string::npos)
        << errors[0].message;
    EXPECT_EQ(errors[0].offset, entry.data_offset);
    EXPECT_NE((*reader)->find("x").data(), nullptr);
}

TEST(Archive, EveryTruncationIsRefused) {
    const Bytes bytes = small_archive();
    for (size_t size = 0; size < bytes.size(); ++size) {
        const Bytes cut(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size));
        EXPECT_FALSE(open_archive_bytes(cut).ok()) << size;
    }
}

TEST(Archive, BytesAfterTheEndOrBetweenEntriesAreFound) {
    Bytes after = small_archive();
    after.push_back(std::byte{0});
    EXPECT_NE(complaints(after), "");

    // An archive with a gap that all records allow for.
    std::vector<ZipRecord> records = {{"a", 0, 1, 0}, {"b", 40, 1, 0}};
    const Bytes contents = {std::byte{'c'}};
    Bytes file;
    for (ZipRecord& record : records) {
        file.resize(record.header_offset);
        record.crc32 = static_cast<uint32_t>(crc32(0, reinterpret_cast<const unsigned char*>(contents.data()), 1));
        append_local_header(file, record);
        append(file, contents);
    }
    const Bytes index = build_index(records);
    records.push_back({std::string(kIndexName), file.size(), index.size(),
                       static_cast<uint32_t>(crc32(0, reinterpret_cast<const unsigned char*>(index.data()), 48))});
    append_local_header(file, records.back());
    append(file, index);
    const uint64_t central = file.size();
    for (const ZipRecord& record : records) append_central_header(file, record);
    append_end_records(file, records.size(), central, file.size() - central);
    const auto reader = open_archive_bytes(file);
    ASSERT_TRUE(reader.ok()) << reader.error().text();
    EXPECT_NE(all_errors((*reader)->verify()).find("before b belong to no entry"), std::string::npos);
}

TEST(Archive, UnsafeAndRepeatedNamesAreRefused) {
    const TemporaryFolder folder;
    for (const std::string name :
         {"", "/a", "a/../b", "..", "./a", "a//b", "a/", "a\\b", "c:a", "a\nb", "\xC3\xBC", "x.3tz/a"}) {
        EXPECT_TRUE(name_defect(name).has_value()) << name;
        EXPECT_FALSE(write_archive(folder / "a.3tz", {{name, "x"}}).ok()) << name;
    }
    EXPECT_FALSE(write_archive(folder / "a.3tz", {{std::string(256, 'n'), "x"}}).ok());
    EXPECT_TRUE(write_archive(folder / "long.3tz", {{std::string(255, 'n'), "x"}}).ok());
    EXPECT_FALSE(write_archive(folder / "a.3tz", {{"twice", "x"}, {"twice", "y"}}).ok());
    EXPECT_FALSE(write_archive(folder / "a.3tz", {{"@3dtilesIndex1@", "x"}}).ok());
    EXPECT_FALSE(write_archive(folder / "a.3tz", {{"empty", ""}}).ok());
    EXPECT_FALSE(write_archive(folder / "a.3tz", {}).ok());
    EXPECT_EQ(folder.file_count(), 1U) << "only long.3tz stays";
}

TEST(Archive, TheReaderRefusesUnsafeAndRepeatedNames) {
    const Bytes good = small_archive();
    const auto with_name = [&](const std::string& from, const std::string& to) {
        Bytes bytes = good;
        const Bytes pattern = to_bytes(from);
        for (auto at = bytes.begin();
             (at = std::search(at, bytes.end(), pattern.begin(), pattern.end())) != bytes.end();) {
            const Bytes other = to_bytes(to);
            at = std::copy(other.begin(), other.end(), at);
        }
        return complaints(bytes);
    };
    EXPECT_NE(with_name("tiles/3/1/2.mesh", "tiles/../1/2.mes").find("not allowed"), std::string::npos);
    EXPECT_NE(with_name("tiles/3/1/2.mesh", "/iles/3/1/2.mesh").find("not allowed"), std::string::npos);
    EXPECT_NE(with_name("tiles/3/1/2.mesh", "tiles\\3/1/2.mesh").find("not allowed"), std::string::npos);
    EXPECT_NE(with_name("tileset.json", "tiles/3/1.js").find("does not match"), std::string::npos);
}

TEST(Archive, UnfinishedArchivesLeaveNothingBehind) {
    const TemporaryFolder folder;
    {
        auto writer = ArchiveWriter::create(folder / "a.3tz");
        ASSERT_TRUE(writer.ok());
        ASSERT_TRUE((*writer)->add("a", to_bytes("b")).ok());
        EXPECT_EQ(folder.file_count(), 1U);
        EXPECT_FALSE(std::filesystem::exists(folder / "a.3tz"));
    }
    EXPECT_EQ(folder.file_count(), 0U);
    auto writer = ArchiveWriter::create(folder / "a.3tz");
    ASSERT_TRUE((*writer)->add("a", to_bytes("b")).ok());
    EXPECT_FALSE((*writer)->add("a", to_bytes("b")).ok());
    EXPECT_EQ(folder.file_count(), 0U) << "removed as soon as it failed";
    EXPECT_FALSE((*writer)->finish().ok());
}

TEST(Archive, AKilledWriterLeavesNoFileUnderTheFinalName) {
    const TemporaryFolder folder;
    const pid_t child = ::fork();
    if (child == 0) {
        auto writer = ArchiveWriter::create(folder / "a.3tz");
        const Bytes large(3 << 20);
        (void)(*writer)->add("a", large).ok();
        ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.3tz"));
    ASSERT_TRUE(write_archive(folder / "a.3tz", kSmall).ok()) << "and the next build is not in its way";
}

TEST(Archive, AFinishedArchiveReplacesTheOldOneWhole) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_archive(folder / "a.3tz", {{"old", "x"}}).ok());
    const auto old_reader = ArchiveReader::open(folder / "a.3tz");
    ASSERT_TRUE(write_archive(folder / "a.3tz", {{"new", "x"}}).ok());
    EXPECT_NE((*old_reader)->find("old").data(), nullptr) << "an open archive stays readable";
    EXPECT_NE((*ArchiveReader::open(folder / "a.3tz"))->find("new").data(), nullptr);
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(Archive, FilesThatCannotBeOpenedSayWhichAndWhy) {
    const TemporaryFolder folder;
    const auto absent = ArchiveReader::open(folder / "absent.3tz");
    ASSERT_FALSE(absent.ok());
    EXPECT_NE(absent.error().message.find("absent.3tz: cannot open: No such file"), std::string::npos);
    EXPECT_FALSE(ArchiveReader::open(folder / ".").ok());
    EXPECT_FALSE(ArchiveWriter::create(folder / "no/such/folder/a.3tz").ok());
}

TEST(Archive, MoreThan65535EntriesUseZip64) {
    const TemporaryFolder folder;
    auto writer = ArchiveWriter::create(folder / "a.3tz");
    const Bytes contents = to_bytes("content");
    for (int i = 0; i < 66'000; ++i) ASSERT_TRUE((*writer)->add("t/" + std::to_string(i), contents).ok());
    ASSERT_TRUE((*writer)->finish().ok());
    const auto reader = ArchiveReader::open(folder / "a.3tz");
    ASSERT_TRUE(reader.ok()) << reader.error().text();
    EXPECT_EQ((*reader)->entries().size(), 66'000U);
    EXPECT_EQ((*reader)->find("t/65999").size(), contents.size());
    EXPECT_EQ(all_errors((*reader)->verify()), "");
}

// A sparse file: one entry of almost 4 GiB of zeros, so that everything behind it needs 64-bit offsets.
TEST(Archive, EntriesBeyond4GiBAreFound) {
    const TemporaryFolder folder;
    const std::string path = folder / "huge.3tz";
    const Bytes contents = to_bytes("behind four gigabytes");
    std::vector<ZipRecord> records = {{"huge", 0, kMaxEntryBytes, 0}};
    Bytes head;
    append_local_header(head, records[0]);
    const uint64_t tail_offset = head.size() + kMaxEntryBytes;
    ASSERT_GE(tail_offset, uint64_t{kMax32});
    const auto crc = [](const Bytes& bytes) {
        return static_cast<uint32_t>(crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
    };
    Bytes tail;
    records.push_back({"behind", tail_offset, contents.size(), crc(contents)});
    append_local_header(tail, records.back());
    append(tail, contents);
    const Bytes index = build_index(records);
    records.push_back({std::string(kIndexName), tail_offset + tail.size(), index.size(), crc(index)});
    append_local_header(tail, records.back());
    append(tail, index);
    const uint64_t central = tail_offset + tail.size();
    for (const ZipRecord& record : records) append_central_header(tail, record);
    append_end_records(tail, records.size(), central, tail_offset + tail.size() - central);
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT, 0644);
    ASSERT_EQ(::pwrite(file, head.data(), head.size(), 0), static_cast<ssize_t>(head.size()));
    const ssize_t written = ::pwrite(file, tail.data(), tail.size(), static_cast<off_t>(tail_offset));
    ::close(file);
    if (written != static_cast<ssize_t>(tail.size())) GTEST_SKIP() << "the file system holds no sparse file of 4 GiB";
    const auto reader = ArchiveReader::open(path);
    ASSERT_TRUE(reader.ok()) << reader.error().text();
    const auto found = (*reader)->find("behind");
    EXPECT_EQ(Bytes(found.begin(), found.end()), contents);
    EXPECT_EQ((*reader)->find("huge").size(), kMaxEntryBytes);
}

}  // namespace
}  // namespace citystream::tiles::archive
