#include "server/http/multipart.h"

#include <gtest/gtest.h>

#include "client/contract/problem.h"

namespace mapweld::server {
namespace {

std::string code_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const contract::ContractError& error) {
    return std::string(error.code().word());
  }
  return "none";
}

TEST(Multipart, SplitsPartsInTheirOrder) {
  const std::string body =
      "--X\r\nContent-Disposition: form-data; name=\"image\"; filename=\"b.jpg\"\r\nContent-Type: image/jpeg\r\n\r\n"
      "one\r\n--X\r\ncontent-disposition: form-data; filename=a.jpg; name=image\r\n\r\n\r\ntwo\r\n--Xno\r\n"
      "\r\n--X\r\nContent-Disposition: form-data; name=\"empty\"\r\n\r\n\r\n--X--\r\nepilogue";
  const std::vector<Part> parts = parse_multipart(body, "X", 64);
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[0].file_name, "b.jpg");
  EXPECT_EQ(parts[0].name, "image");
  EXPECT_EQ(parts[0].content, "one");
  EXPECT_EQ(parts[1].file_name, "a.jpg");
  EXPECT_EQ(parts[1].content, "\r\ntwo\r\n--Xno\r\n");
  EXPECT_EQ(parts[2].file_name, "");
  EXPECT_EQ(parts[2].content, "");
}

TEST(Multipart, BinaryContentPassesUnchanged) {
  std::string image;
  for (int i = 0; i < 5000; ++i) image.push_back(static_cast<char>(i * 37 % 256));
  image += "\r\n--";
  const std::string body =
      "preamble\r\n--b\r\nContent-Disposition: form-data; name=\"i\"; filename=\"x\"\r\n\r\n" + image + "\r\n--b--";
  const std::vector<Part> parts = parse_multipart(body, "b", 64);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].content, image);
}

TEST(Multipart, ReadsFileNamesAsClientsWriteThem) {
  const auto name = [](const std::string& parameter) {
    const std::string body =
        "--b\r\nContent-Disposition: form-data; name=\"i\"; filename=" + parameter + "\r\n\r\nx\r\n--b--";
    return parse_multipart(body, "b", 64).at(0).file_name;
  };
  EXPECT_EQ(name("\"a;b=c.jpg\""), "a;b=c.jpg");
  EXPECT_EQ(name("\"say \\\"hi\\\".jpg\""), "say \"hi\".jpg");
  EXPECT_EQ(name("\"say %22hi%22.jpg\""), "say \"hi\".jpg");
  EXPECT_EQ(name("\"100%.jpg\""), "100%.jpg");
  EXPECT_EQ(name("\"lap-1/001.jpg\""), "lap-1/001.jpg");
  EXPECT_EQ(name("\"küche.jpg\""), "küche.jpg");
}

TEST(Multipart, RefusesWhatIsNotOne) {
  const std::string head = "--b\r\nContent-Disposition: form-data; name=\"i\"\r\n\r\n";
  const auto parse = [](const std::string& body) { return code_of([&] { parse_multipart(body, "b", 2); }); };
  EXPECT_EQ(parse(head + "x\r\n--b--"), "none");
  EXPECT_EQ(parse(""), "malformed_multipart");
  EXPECT_EQ(parse("hello"), "malformed_multipart");
  EXPECT_EQ(parse(head + "x"), "malformed_multipart");              // breaks off
  EXPECT_EQ(parse(head + "x\r\n--b"), "malformed_multipart");       // in the boundary
  EXPECT_EQ(parse(head + "x\r\n--bc\r\n"), "malformed_multipart");  // never closed
  EXPECT_EQ(parse("--b\r\nno colon\r\n\r\nx\r\n--b--"), "malformed_multipart");
  EXPECT_EQ(parse("--b\r\nContent-Disposition: form-data; name=\"i\r\n\r\nx\r\n--b--"), "malformed_multipart");
  EXPECT_EQ(parse("--b\r\nContent-Disposition: attachment\r\n\r\nx\r\n--b--"), "malformed_multipart");
  EXPECT_EQ(parse("--b\r\nContent-Transfer-Encoding: base64\r\n\r\nx\r\n--b--"), "malformed_multipart");
  EXPECT_EQ(parse("--b\r\nX: " + std::string(10'000, 'x') + "\r\n\r\nx\r\n--b--"), "malformed_multipart");
  const std::string part = "x\r\n" + head;
  EXPECT_EQ(parse(head + part + part + "x\r\n--b--"), "too_many_images");
}

TEST(Multipart, FindsTheBoundary) {
  EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=abc"), "abc");
  EXPECT_EQ(multipart_boundary("Multipart/Form-Data; charset=utf-8; Boundary=\"a b\""), "a b");
  EXPECT_EQ(code_of([] { multipart_boundary("image/jpeg"); }), "unsupported_media_type");
  EXPECT_EQ(code_of([] { multipart_boundary("multipart/form-data"); }), "malformed_multipart");
  EXPECT_EQ(code_of([] { multipart_boundary("multipart/form-data; boundary="); }), "malformed_multipart");
  EXPECT_EQ(code_of([] { multipart_boundary("multipart/form-data; boundary=" + std::string(71, 'x')); }),
            "malformed_multipart");
}

}  // namespace
}  // namespace mapweld::server
