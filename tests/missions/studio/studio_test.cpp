// The studio's server with hostile requests, and its files, edits and commands.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "geometry/error.h"
#include "geometry/io/record_log.h"
#include "missions/studio/command_table.h"
#include "missions/studio/mission_edit.h"
#include "missions/studio/service.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::studio {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// A studio on a free port with the folder `work` and a secret file next to it.
class Studio : public testing::Test {
 protected:
  Studio() {
    fs::create_directories(folder_.path() / "work" / "results");
    write("secret.yaml", "name: secret\n");
    write("work/house.yaml", "name: house\nlimits: {max_views: 3}\n");
    fs::create_symlink("../secret.yaml", folder_.path() / "work/link.yaml");
    fs::create_directory_symlink("..", folder_.path() / "work/up");
    service_ = std::make_unique<Service>(WorkFolder(folder_.path() / "work"), SKYCAP_PROGRAM, "");
    server_ = make_http_server(0, *service_);
    service_->set_port(server_->port());
    thread_ = std::thread([this] { server_->run(); });
  }
  ~Studio() override {
    server_->stop();
    service_->stop();
    thread_.join();
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }
  std::string read(const std::string& name) const {
    std::ifstream stream(folder_.path() / name);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  std::string host() const { return "127.0.0.1:" + std::to_string(server_->port()); }
  std::string page() const { return "/" + service_->guard().page_token(); }
  std::string files() const { return "/" + service_->guard().file_token(); }

  int connect() const {
    const int connection = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(server_->port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    return connection;
  }
  /// Sends bytes and returns everything that the server sends until it closes the connection.
  std::string send(const std::string& bytes) const {
    const int connection = connect();
    for (std::size_t sent = 0; sent < bytes.size();) {
      const ssize_t count =
          ::send(connection, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) break;  // rejected before everything was sent
      sent += static_cast<std::size_t>(count);
    }
    std::string answer;
    char buffer[4096];
    for (ssize_t count = 0; (count = ::recv(connection, buffer, sizeof buffer, 0)) > 0;) {
      answer.append(buffer, static_cast<std::size_t>(count));
    }
    ::close(connection);
    return answer;
  }
  std::string get(const std::string& path, const std::string& headers = "") const {
    return send("GET " + path + " HTTP/1.1\r\nHost: " + host() + "\r\n" + headers + "\r\n");
  }
  std::string post(const std::string& path, const std::string& body,
                   const std::string& headers) const {
    return send("POST " + path + " HTTP/1.1\r\nHost: " + host() + "\r\n" + headers +
                "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  }
  std::string own_headers() const {
    return "Origin: http://" + host() + "\r\nContent-Type: application/json\r\n";
  }
  std::string post(const std::string& path, const std::string& body) const {
    return post(page() + path, body, own_headers());
  }
  bool serves() const { return get(page() + "/api/state").starts_with("HTTP/1.1 200"); }

  testing_support::TemporaryFolder folder_;
  std::unique_ptr<Service> service_;
  std::unique_ptr<HttpServer> server_;
  std::thread thread_;
};

const auto ok = StartsWith("HTTP/1.1 200");
const auto forbidden = StartsWith("HTTP/1.1 403");

TEST_F(Studio, ServesThePageWithItsTokenOnly) {
  EXPECT_THAT(get(page() + "/"), AllOf(ok, HasSubstr("Skycap studio"), HasSubstr("no-referrer")));
  std::string wrong = page();
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  for (const std::string& path : {std::string("/"), std::string("/api/state"), wrong + "/",
                                  page().substr(0, 20) + "/", page() + "0/", "//" + page(),
                                  "\xff" + page().substr(1) + "/", "?" + page().substr(1) + "/"}) {
    EXPECT_THAT(get(path), forbidden) << path;
  }
  EXPECT_NE(service_->guard().page_token(), service_->guard().file_token());
  EXPECT_NE(make_token(), make_token());
}

TEST_F(Studio, RejectsOtherHosts) {
  const std::string rest = page() + "/api/state HTTP/1.1\r\n";
  EXPECT_THAT(send("GET " + rest + "Host: evil.example:80\r\n\r\n"), forbidden);
  EXPECT_THAT(send("GET " + rest + "Host: 127.0.0.1\r\n\r\n"), forbidden);
  EXPECT_THAT(send("GET " + rest + "\r\n"), forbidden);
  EXPECT_THAT(send("GET " + rest + "Host: " + host() + "\r\nHost: evil.example\r\n\r\n"),
              forbidden);
  EXPECT_THAT(
      send("GET " + rest + "Host: localhost:" + std::to_string(server_->port()) + "\r\n\r\n"), ok);
}

TEST_F(Studio, RejectsOtherOrigins) {
  const std::string path = page() + "/api/state";
  EXPECT_THAT(get(path, "Origin: http://" + host() + "\r\n"), ok);
  EXPECT_THAT(get(path, "Origin: https://evil.example\r\n"), forbidden);
  EXPECT_THAT(get(path, "Origin: null\r\n"), forbidden);
  const std::string edit = R"({"text": "a: 1", "key": "", "value": ""})";
  EXPECT_THAT(post("/api/edit", edit), ok);
  const std::string json = "Content-Type: application/json\r\n";
  EXPECT_THAT(post(page() + "/api/edit", edit, json), forbidden);
  EXPECT_THAT(post(page() + "/api/edit", edit, "Origin: null\r\n" + json), forbidden);
  EXPECT_THAT(post(files() + "/api/edit", edit, own_headers()), forbidden);
}

TEST_F(Studio, AcceptsOnlyJsonAndKnownMethods) {
  const std::string origin = "Origin: http://" + host() + "\r\n";
  EXPECT_THAT(post(page() + "/api/edit", "{}", origin + "Content-Type: text/plain\r\n"),
              StartsWith("HTTP/1.1 415"));
  EXPECT_THAT(post(page() + "/api/edit", "{}", own_headers() + "Content-Encoding: gzip\r\n"),
              StartsWith("HTTP/1.1 415"));
  for (const char* body : {"", "{", "[]", "{\"text\": 7}", "\xff\xfe"}) {
    EXPECT_THAT(post("/api/edit", body), StartsWith("HTTP/1.1 400")) << body;
  }
  EXPECT_THAT(post("/api/edit", std::string(100'000, '[')), StartsWith("HTTP/1.1 400"));
  for (const char* method : {"PUT", "DELETE", "OPTIONS", "PATCH"}) {
    EXPECT_THAT(send(std::string(method) + " " + page() + "/ HTTP/1.1\r\nHost: " + host() +
                     "\r\nContent-Length: 0\r\n\r\n"),
                StartsWith("HTTP/1.1 405"))
        << method;
  }
  EXPECT_TRUE(serves());
}

TEST_F(Studio, ServesOnlyFilesOfItsFolder) {
  EXPECT_THAT(get(files() + "/house.yaml"),
              AllOf(ok, HasSubstr("name: house"), HasSubstr("sandbox allow-scripts")));
  for (const char* path : {"/../secret.yaml", "/%2e%2e/secret.yaml", "/results/../../secret.yaml",
                           "/..%2fsecret.yaml", "/link.yaml", "/up/secret.yaml", "//etc/passwd",
                           "/%2fetc%2fpasswd", "/house.yaml%00.html", "/.", "/", "", "/results"}) {
    const std::string answer = get(files() + path);
    EXPECT_THAT(answer, Not(ok)) << path;
    EXPECT_THAT(answer, Not(HasSubstr("name: secret"))) << path;
  }
  const std::string save = R"({"path": "../secret.yaml", "text": "name: mine", "version": ""})";
  EXPECT_THAT(post("/api/save", save), StartsWith("HTTP/1.1 400"));
  EXPECT_EQ(read("secret.yaml"), "name: secret\n");
}

TEST_F(Studio, BoundsTheSizeOfRequests) {
  const std::string large(HttpServer::max_body + 1, 'x');
  EXPECT_THAT(post("/api/edit", large), Not(ok));
  EXPECT_THAT(get(page() + "/api/state?x=" + std::string(100'000, 'x')), Not(ok));
  std::string headers;
  for (int i = 0; i < 200'000; ++i)
    headers += "X-" + std::to_string(i) + ": " + std::string(40, 'x') + "\r\n";
  EXPECT_THAT(get(page() + "/api/state", headers), Not(ok));
  EXPECT_TRUE(serves());
}

TEST_F(Studio, SurvivesMalformedRequests) {
  for (const std::string& bytes :
       {std::string("\r\n\r\n"), std::string("GET\r\n\r\n"), std::string("GET / HTTP/9.9\r\n\r\n"),
        std::string(5000, '\0') + "\r\n\r\n", std::string("\x16\x03\x01\x02\x00"),
        "GET " + page() + "/%zz%  HTTP/1.1\r\nHost: " + host() + "\r\n\r\n",
        "POST " + page() + "/api/edit HTTP/1.1\r\nHost: " + host() + "\r\n" + own_headers() +
            "Transfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\nx\r\n"}) {
    EXPECT_THAT(send(bytes), Not(ok));
  }
  EXPECT_TRUE(serves());
}

// A request that does not arrive within three seconds is closed, and others are served meanwhile.
TEST_F(Studio, ClosesSlowRequests) {
  const int slow = connect();
  ::send(slow, "GET / HT", 8, MSG_NOSIGNAL);
  EXPECT_TRUE(serves());
  const auto start = std::chrono::steady_clock::now();
  char byte = 0;
  while (::recv(slow, &byte, 1, 0) > 0) {
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  ::close(slow);
}

TEST_F(Studio, SavesOnlyTheVersionThatWasRead) {
  const WorkFolder& folder = service_->folder();
  const VersionedText first = folder.read("house.yaml");
  const std::string second = folder.save("house.yaml", "name: second\n", first.version);
  EXPECT_EQ(folder.read("house.yaml").version, second);
  try {
    folder.save("house.yaml", "name: third\n", first.version);
    ADD_FAILURE() << "expected a conflict";
  } catch (const SaveConflict& conflict) {
    EXPECT_EQ(conflict.on_disk.text, "name: second\n");
  }
  EXPECT_THROW(folder.save("house.yaml", "name: third\n", ""), SaveConflict);
  EXPECT_EQ(read("work/house.yaml"), "name: second\n");
  folder.save("new.yaml", "name: new\n", "");
  EXPECT_EQ(read("work/new.yaml"), "name: new\n");
  EXPECT_THROW(folder.save("new.kmz", "x", ""), Error);
  EXPECT_THROW(folder.save(".hidden.yaml", "x", ""), Error);
}

TEST_F(Studio, ListsResultsAndLiveSurveys) {
  for (const char* name : {"plan/summary.json", "live/live.journal", "other/notes.txt"}) {
    fs::create_directories((folder_.path() / "work" / name).parent_path());
    write("work/" + std::string(name), "{}");
  }
  std::vector<std::string> packages, lives;
  for (const ListedFile& file : service_->folder().list().files) {
    if (file.kind == "package") packages.push_back(file.path);
    if (file.kind == "live") lives.push_back(file.path);
  }
  EXPECT_THAT(packages, ElementsAre("plan"));
  EXPECT_THAT(lives, ElementsAre("live"));
}

TEST_F(Studio, ReportsTheViewsOfARunningSurvey) {
  fs::create_directories(folder_.path() / "work/plan");
  EXPECT_THAT(get(page() + "/api/progress?path=plan"), AllOf(ok, HasSubstr("\"views\":[]")));
  {
    geometry::RecordLog log(folder_.path() / "work/plan/survey.journal");
    log.append("{}");
    for (const char* x : {"1.5", "2.5"}) {
      log.append(std::string(R"({"position": [)") + x +
                 R"(, 0, 9], "direction": [1, 0, 0], "returns": 5, "points": 4, "next": {}})");
    }
  }
  EXPECT_THAT(get(page() + "/api/progress?path=plan"), AllOf(HasSubstr("1.5"), HasSubstr("2.5")));
  EXPECT_THAT(get(page() + "/api/progress?path=plan&from=1"),
              AllOf(Not(HasSubstr("1.5")), HasSubstr("2.5"), HasSubstr("\"from\":1")));
  EXPECT_THAT(get(page() + "/api/progress?path=missing"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get(page() + "/api/progress?path=../work/plan"), StartsWith("HTTP/1.1 400"));
  std::string text = read("work/plan/survey.journal");
  text[0] = text[0] == '0' ? '1' : '0';  // a checksum
  write("work/plan/survey.journal", text);
  EXPECT_THAT(get(page() + "/api/progress?path=plan"), StartsWith("HTTP/1.1 400"));
}

TEST_F(Studio, SendsThePreviewOfARunningSurveyFromAPoint) {
  fs::create_directories(folder_.path() / "work/plan");
  const std::string path = page() + "/api/progress?path=plan";
  EXPECT_THAT(get(path), AllOf(ok, HasSubstr("\"stride\":0")));
  {
    geometry::RecordLog log(folder_.path() / "work/plan/survey.points");
    log.append(R"({"stride":2})");
    log.append("[1,2,3,4,5,6]");
    log.append("[7,8,9]");
  }
  EXPECT_THAT(get(path), HasSubstr(R"({"stride":2,"from":0,"points":[1,2,3,4,5,6,7,8,9]})"));
  EXPECT_THAT(get(path + "&stride=2&points=2"),
              HasSubstr(R"({"stride":2,"from":2,"points":[7,8,9]})"));
  // The preview was rewritten with a larger stride.
  EXPECT_THAT(get(path + "&stride=1&points=2"), HasSubstr(R"("from":0,"points":[1,2,3,)"));
  EXPECT_THAT(get(path + "&stride=2&points=-1"), HasSubstr(R"("from":0,)"));
}

TEST_F(Studio, ShowsAndHoldsALiveSurvey) {
  fs::create_directories(folder_.path() / "work/live");
  fs::create_directories(folder_.path() / "work/other");
  write("work/live/live.journal", "");
  const std::string path = page() + "/api/live?path=live";
  EXPECT_THAT(get(path), AllOf(ok, HasSubstr(R"({"running":false,"hold":false})")));
  write("work/live/live.json", R"({"held":false,"action":"flying"})");
  EXPECT_THAT(get(path), HasSubstr(R"("running":true,"hold":false,"status":{"held":false)"));
  EXPECT_THAT(post("/api/live", R"({"path":"live","held":true})"), HasSubstr("\"hold\":true"));
  EXPECT_TRUE(fs::exists(folder_.path() / "work/live/live.hold"));
  EXPECT_THAT(post("/api/live", R"({"path":"live","held":false})"), HasSubstr("\"hold\":false"));
  EXPECT_FALSE(fs::exists(folder_.path() / "work/live/live.hold"));
  // The status of a killed program is not shown.
  fs::last_write_time(folder_.path() / "work/live/live.json",
                      fs::file_time_type::clock::now() - std::chrono::seconds(10));
  EXPECT_THAT(get(path), HasSubstr("\"running\":false"));
  EXPECT_THAT(post("/api/live", R"({"path":"other","held":true})"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(post("/api/live", R"({"path":"../work/live","held":true})"),
              StartsWith("HTTP/1.1 400"));
  EXPECT_FALSE(fs::exists(folder_.path() / "work/other/live.hold"));
  fs::create_symlink("../../secret.yaml", folder_.path() / "work/live/live.hold");
  EXPECT_THAT(post("/api/live", R"({"path":"live","held":true})"), StartsWith("HTTP/1.1 400"));
  EXPECT_EQ(read("secret.yaml"), "name: secret\n");
}

TEST_F(Studio, SendsAMissionOnlyIfItHasChanged) {
  const std::string version = service_->folder().read("house.yaml").version;
  const std::string path = page() + "/api/mission?path=house.yaml&version=";
  EXPECT_THAT(get(path + version), AllOf(ok, Not(HasSubstr("text"))));
  EXPECT_THAT(get(path), AllOf(ok, HasSubstr("max_views: 3")));
}

TEST_F(Studio, ReceivesAFileInPieces) {
  const auto piece = [&](const std::string& at, const std::string& bytes) {
    return post(page() + "/api/uploads/" + at, bytes,
                "Origin: http://" + host() + "\r\nContent-Type: application/octet-stream\r\n");
  };
  const auto begin = [&](const char* name, const char* replace) {
    return post("/api/uploads", std::string(R"({"name": ")") + name +
                                    R"(", "bytes": 8, "replace": )" + replace + "}");
  };
  const std::string bytes("a\0b\xff\n12", 7);
  EXPECT_THAT(begin("cloud.las", "false"),
              AllOf(StartsWith("HTTP/1.1 201"), HasSubstr("{\"id\":1}")));
  EXPECT_THAT(piece("1?offset=0", bytes), ok);
  EXPECT_THAT(post("/api/uploads/1/end", "{}"),
              AllOf(StartsWith("HTTP/1.1 400"), HasSubstr("1 bytes")));
  EXPECT_FALSE(fs::exists(folder_.path() / "work/cloud.las"));
  EXPECT_THAT(piece("1?offset=0", "3"), StartsWith("HTTP/1.1 400"));   // repeated
  EXPECT_THAT(piece("1?offset=7", "34"), StartsWith("HTTP/1.1 400"));  // too long
  EXPECT_THAT(piece("1?offset=7", "3"), ok);
  EXPECT_THAT(post("/api/uploads/1/end", "{}"), AllOf(ok, HasSubstr("cloud.las")));
  EXPECT_EQ(read("work/cloud.las"), bytes + "3");

  // An existing file is replaced on request only.
  EXPECT_THAT(begin("cloud.las", "false"),
              AllOf(StartsWith("HTTP/1.1 409"), HasSubstr("conflict")));
  EXPECT_THAT(begin("cloud.las", "true"), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(begin("cloud.las", "true"), StartsWith("HTTP/1.1 400"));  // sent by another page
  EXPECT_THAT(piece("2?offset=0", "replaced"), ok);
  EXPECT_EQ(read("work/cloud.las"), bytes + "3");
  EXPECT_THAT(post("/api/uploads/2/end", "{}"), ok);
  EXPECT_EQ(read("work/cloud.las"), "replaced");

  // A file that was created meanwhile is not replaced either.
  EXPECT_THAT(begin("tile.gml", "false"), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(piece("3?offset=0", "12345678"), ok);
  write("work/tile.gml", "theirs");
  EXPECT_THAT(post("/api/uploads/3/end", "{}"), StartsWith("HTTP/1.1 409"));
  EXPECT_EQ(read("work/tile.gml"), "theirs");

  EXPECT_THAT(begin("mesh.ply", "false"), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(post("/api/uploads/4/cancel", "{}"), ok);
  EXPECT_THAT(piece("4?offset=0", "12345678"), StartsWith("HTTP/1.1 400"));
  for (const auto& entry : fs::directory_iterator(folder_.path() / "work")) {
    EXPECT_THAT(entry.path().filename().string(), Not(StartsWith("."))) << "temporary file";
  }
}

TEST_F(Studio, RejectsUploadsUnderOtherNamesAndWithoutThePage) {
  for (const char* name : {"../x.las", "a/x.las", "a\\\\x.las", ".x.las", "x.html", "x.so", "x.py",
                           "x", "", "/x.las", "results", "x.las\\u0000.gml", "..", "link.yaml"}) {
    EXPECT_THAT(post("/api/uploads",
                     std::string(R"({"name": ")") + name + R"(", "bytes": 1, "replace": true})"),
                StartsWith("HTTP/1.1 400"))
        << name;
  }
  for (const char* bytes : {"5000000000", "-1", "1e30", "\"1\""}) {
    EXPECT_THAT(post("/api/uploads",
                     std::string(R"({"name": "x.las", "replace": false, "bytes": )") + bytes + "}"),
                StartsWith("HTTP/1.1 400"))
        << bytes;
  }
  const std::string binary = "Content-Type: application/octet-stream\r\n";
  const std::string path = page() + "/api/uploads/1?offset=0";
  EXPECT_THAT(post(path, "x", binary), forbidden);  // without Origin
  EXPECT_THAT(post(path, "x", own_headers()), StartsWith("HTTP/1.1 415"));
  EXPECT_THAT(
      post(page() + "/api/save?offset=0", "{}", "Origin: http://" + host() + "\r\n" + binary),
      StartsWith("HTTP/1.1 415"));
  EXPECT_EQ(read("secret.yaml"), "name: secret\n");
  EXPECT_TRUE(serves());
}

TEST_F(Studio, RunsACommandThatASecondPageFinds) {
  const std::string started =
      post("/api/jobs", R"({"command": "presets", "options": {"--json": true}})");
  EXPECT_THAT(started, StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(get(page() + "/api/jobs/1/events"), HasSubstr("\"running\":false"));
  EXPECT_THAT(get(page() + "/api/state"), HasSubstr("skycap presets --json"));
  EXPECT_THAT(get(page() + "/api/jobs/2"), StartsWith("HTTP/1.1 404"));
}

TEST(CommandTable, PermitsOnlyKnownOptionsAndFilesOfTheFolder) {
  const testing_support::TemporaryFolder temporary;
  const WorkFolder folder(temporary.path());
  EXPECT_THAT(make_arguments("site", {{"map", {"tile.gml"}}, {"--id", {"--out=x", "b"}}}, folder),
              ElementsAre("site", "tile.gml", "--id=--out=x", "--id=b"));
  EXPECT_THAT(make_arguments("plan", {{"mission", {"-x.yaml"}}, {"--resume", {""}}}, folder),
              ElementsAre("plan", "./-x.yaml", "--resume"));
  EXPECT_THROW(make_arguments("model", {}, folder), Error);
  EXPECT_THROW(make_arguments("plan", {}, folder), Error);
  EXPECT_THROW(make_arguments("plan", {{"mission", {"a"}}, {"--set", {"a=b"}}}, folder), Error);
  EXPECT_THAT(
      make_arguments("plan", {{"mission", {"a"}}, {"--set", {"flight.views=replanned"}}}, folder),
      ElementsAre("plan", "a", "--set=flight.views=replanned"));
  EXPECT_THROW(make_arguments("plan", {{"mission", {"a"}}, {"--planner", {"x.py"}}}, folder),
               Error);
  EXPECT_THROW(make_arguments("plan", {{"mission", {"../a"}}}, folder), Error);
  EXPECT_THROW(make_arguments("init", {{"target", {"a"}}, {"--sensor", {"/etc/a.yaml"}}}, folder),
               Error);
  EXPECT_EQ(shell_text({"site", "it's"}), "skycap site 'it'\\''s'");
}

TEST(MissionEdit, PreservesCommentsAndLayout) {
  const std::string text =
      "name: house  # the name\n"
      "flight:  # of the vehicle\n"
      "  vehicle: m350_rtk\n"
      "  takeoff: [1, 2, 3]  # pad\n"
      "limits: {max_views: 12, stand_off: 3}\n";
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string copy = text;
    return copy.replace(copy.find(from), from.size(), to);
  };
  EXPECT_EQ(with_key(text, "name", "'a b'"), replaced("house", "'a b'"));
  EXPECT_EQ(with_key(text, "flight.takeoff", "[4, 5, 6]"), replaced("[1, 2, 3]", "[4, 5, 6]"));
  EXPECT_EQ(with_key(text, "limits.max_views", "7"), replaced("12", "7"));
  EXPECT_EQ(with_key(text, "limits.stand_off", ""), replaced(", stand_off: 3", ""));
  EXPECT_EQ(with_key(text, "limits.max_views", ""), replaced("max_views: 12, ", ""));
  EXPECT_EQ(with_key(text, "flight.vehicle", ""), replaced("  vehicle: m350_rtk\n", ""));
  EXPECT_EQ(with_key(text, "limits.speed", "2"), replaced("{max", "{speed: 2, max"));
  EXPECT_EQ(with_key(text, "flight.clearance", "2"),
            replaced("vehicle\n  vehicle", "vehicle\n  clearance: 2\n  vehicle"));
  EXPECT_EQ(with_key(text, "site.max_height", "50"), text + "site:\n  max_height: 50\n");
  EXPECT_EQ(with_key(text, "site.max_height", ""), text);
  const std::string box = with_key(text, "planner.scene_box.min", "[1, 2, 3]");
  EXPECT_EQ(box, text + "planner:\n  scene_box:\n    min: [1, 2, 3]\n");
  EXPECT_EQ(with_key(box, "planner.scene_box.min", ""), text + "planner:\n");
  EXPECT_EQ(list_values(text, "x").at("flight.takeoff"), "[1, 2, 3]");
}

TEST(MissionEdit, ReplacesValuesOfSeveralLinesAndPreservesTheirComments) {
  const std::string text =
      "site:\n"
      "  no_fly:  # of the town\n"
      "    - corners: [[0, 0], [4, 0], [4, 4]]  # school\n"
      "      floor: 0\n"
      "    # the pond\n"
      "    - {corners: [[9, 9], [9, 12], [12, 9]], name: 'it''s'}\n"
      "  # as in the permit\n"
      "  geofence: [[-80, -80],  # south\n"
      "             [80, -80], [80, 80]]  # end\n"
      "flight:\n"
      "  rally:\n"
      "  - [1, 2, 3]\n"
      "  - [4, 5, 6]\n"
      "\n"
      "# views\n"
      "limits: {max_views: 3}\n";
  const auto values = list_values(text, "x");
  EXPECT_EQ(values.at("site.no_fly"),
            "[{corners: [[0, 0], [4, 0], [4, 4]], floor: 0}, "
            "{corners: [[9, 9], [9, 12], [12, 9]], name: \"it's\"}]");
  EXPECT_EQ(values.at("flight.rally"), "[[1, 2, 3], [4, 5, 6]]");
  EXPECT_THAT(with_key(text, "site.no_fly", "[{corners: [[0, 0], [1, 0], [0, 1]]}]"),
              StartsWith("site:\n  # school\n  # the pond\n"
                         "  no_fly: [{corners: [[0, 0], [1, 0], [0, 1]]}]  # of the town\n"
                         "  # as in the permit\n  geofence: [[-80"));
  EXPECT_THAT(with_key(text, "site.geofence", "[[0, 0], [1, 0], [0, 1]]"),
              HasSubstr("permit\n  # south\n  geofence: [[0, 0], [1, 0], [0, 1]]  # end\nflight:"));
  EXPECT_THAT(with_key(text, "flight.rally", "[[7, 8, 9]]"),
              HasSubstr("flight:\n  rally: [[7, 8, 9]]\n\n# views\nlimits"));
  EXPECT_THAT(with_key(text, "site.no_fly", ""), StartsWith("site:\n  # as in the permit\n"));
  // Setting each value to what it is changes no value.
  for (const auto& [key, value] : values) {
    EXPECT_EQ(list_values(with_key(text, key, value), "x"), values) << key;
  }
}

TEST(MissionEdit, RejectsWhatWouldChangeOtherKeys) {
  for (const char* value : {"1\nname: x", "1, max_distance: 2", "{", "a: b", "# c", "1} x: {"}) {
    EXPECT_THROW(with_key("limits: {max_views: 12}\n", "limits.max_views", value), Error) << value;
  }
  EXPECT_THROW(with_key("{", "name", "x"), Error);
}

}  // namespace
}  // namespace skycap::missions::studio
