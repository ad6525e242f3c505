#pragma once

#include <QAbstractListModel>
#include <QColor>
#include <QImage>
#include <QObject>
#include <QPointF>
#include <QQmlEngine>
#include <QString>
#include <functional>
#include <vector>

#include "interaction/tablet/core/floor_plan.hpp"
#include "interaction/tablet/core/theme.hpp"
#include "interaction/tablet/core/view.hpp"

namespace usher::tablet {

/// Colors and sizes for QML; the values are those of core/theme.hpp.
class Theme : public QObject {
  Q_OBJECT
  QML_ELEMENT
  QML_SINGLETON
  Q_PROPERTY(QColor background READ background CONSTANT)
  Q_PROPERTY(QColor surface READ surface CONSTANT)
  Q_PROPERTY(QColor title READ title CONSTANT)
  Q_PROPERTY(QColor text READ text CONSTANT)
  Q_PROPERTY(QColor status READ status CONSTANT)
  Q_PROPERTY(QColor ink READ ink CONSTANT)
  Q_PROPERTY(QColor focus READ focus CONSTANT)
  Q_PROPERTY(QColor yes READ yes CONSTANT)
  Q_PROPERTY(QColor robot READ robot CONSTANT)
  Q_PROPERTY(double designWidth READ designWidth CONSTANT)
  Q_PROPERTY(double designHeight READ designHeight CONSTANT)
  Q_PROPERTY(double buttonWidth READ buttonWidth CONSTANT)
  Q_PROPERTY(double buttonHeight READ buttonHeight CONSTANT)
  Q_PROPERTY(double titleSize READ titleSize CONSTANT)
  Q_PROPERTY(double buttonTextSize READ buttonTextSize CONSTANT)
  Q_PROPERTY(double statusSize READ statusSize CONSTANT)
  Q_PROPERTY(double mapNameSize READ mapNameSize CONSTANT)

 public:
  static QColor qt(const Color& color) { return {color.red, color.green, color.blue}; }
  QColor background() const { return qt(kPalette.background); }
  QColor surface() const { return qt(kPalette.surface); }
  QColor title() const { return qt(kPalette.title); }
  QColor text() const { return qt(kPalette.text); }
  QColor status() const { return qt(kPalette.status); }
  QColor ink() const { return qt(kPalette.ink); }
  QColor focus() const { return qt(kPalette.focus); }
  QColor yes() const { return qt(kPalette.yes); }
  QColor robot() const { return qt(kPalette.robot); }
  double designWidth() const { return Sizes::kWidth; }
  double designHeight() const { return Sizes::kHeight; }
  double buttonWidth() const { return Sizes::kButtonWidth; }
  double buttonHeight() const { return Sizes::kButtonHeight; }
  double titleSize() const { return Sizes::kTitle; }
  double buttonTextSize() const { return Sizes::kButtonText; }
  double statusSize() const { return Sizes::kStatus; }
  double mapNameSize() const { return Sizes::kMapName; }
  /// Of a button, by its kind.
  Q_INVOKABLE QColor button(int kind) const;
};

/// The buttons of one panel.
class ButtonsModel : public QAbstractListModel {
  Q_OBJECT
  QML_ELEMENT
  QML_UNCREATABLE("belongs to a ScreenModel")
  Q_PROPERTY(int count READ count NOTIFY changed)

 public:
  enum Role { kId = Qt::UserRole, kLabel, kKind, kPending, kActive };
  using QAbstractListModel::QAbstractListModel;
  int rowCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QHash<int, QByteArray> roleNames() const override;
  int count() const { return static_cast<int>(buttons_.size()); }
  void set(const std::vector<Button>& buttons, const std::string& pending);

 signals:
  void changed();

 private:
  std::vector<Button> buttons_;
  std::string pending_;
};

/// A View as QML sees it. Lives on the window's thread.
class ScreenModel : public QObject {
  Q_OBJECT
  QML_ELEMENT
  QML_UNCREATABLE("made by the application")
  Q_PROPERTY(int page READ page NOTIFY changed)
  Q_PROPERTY(QString state READ state NOTIFY changed)
  Q_PROPERTY(QString title READ title NOTIFY changed)
  Q_PROPERTY(QString text READ text NOTIFY changed)
  Q_PROPERTY(QString status READ status NOTIFY changed)
  Q_PROPERTY(bool stopOffered READ stopOffered NOTIFY changed)
  Q_PROPERTY(bool startOffered READ startOffered NOTIFY changed)
  Q_PROPERTY(bool startActive READ startActive NOTIFY changed)
  Q_PROPERTY(QString stopLabel READ stopLabel NOTIFY changed)
  Q_PROPERTY(QString startLabel READ startLabel NOTIFY changed)
  Q_PROPERTY(QString queryLabel READ queryLabel NOTIFY changed)
  Q_PROPERTY(double timeLeft READ timeLeft NOTIFY changed)
  Q_PROPERTY(double timeLeftShare READ timeLeftShare NOTIFY changed)
  Q_PROPERTY(double progress READ progress NOTIFY changed)
  Q_PROPERTY(QString wayText READ wayText NOTIFY changed)
  Q_PROPERTY(QString hereLabel READ hereLabel NOTIFY changed)
  Q_PROPERTY(bool located READ located NOTIFY changed)
  Q_PROPERTY(double robotX READ robotX NOTIFY changed)
  Q_PROPERTY(double robotY READ robotY NOTIFY changed)
  Q_PROPERTY(double robotDegrees READ robotDegrees NOTIFY changed)
  Q_PROPERTY(double pixelsPerMeter READ pixelsPerMeter NOTIFY buildingChanged)
  Q_PROPERTY(int planWidth READ planWidth NOTIFY buildingChanged)
  Q_PROPERTY(int planHeight READ planHeight NOTIFY buildingChanged)
  Q_PROPERTY(usher::tablet::ButtonsModel* primary READ primary CONSTANT)
  Q_PROPERTY(usher::tablet::ButtonsModel* secondary READ secondary CONSTANT)
  Q_PROPERTY(usher::tablet::ButtonsModel* service READ service CONSTANT)
  Q_PROPERTY(QString typed READ typed NOTIFY typedChanged)

 public:
  enum class PageName { Away, Starting, Buttons, Map, Journey, Search };
  Q_ENUM(PageName)

  explicit ScreenModel(QObject* parent = nullptr) : QObject(parent) {}

  int page() const { return static_cast<int>(view_.page); }
  QString state() const { return text(view_.state); }
  QString title() const { return text(view_.title); }
  QString text() const { return text(view_.text); }
  QString status() const { return text(view_.status); }
  bool stopOffered() const { return view_.stop_offered; }
  bool startOffered() const { return view_.start_offered; }
  bool startActive() const { return view_.start_active; }
  QString stopLabel() const { return text(view_.stop_label); }
  QString startLabel() const { return text(view_.start_label); }
  QString queryLabel() const { return text(view_.query_label); }
  double timeLeft() const { return view_.time_left; }
  double timeLeftShare() const { return view_.time_left_share; }
  double progress() const { return view_.progress; }
  QString wayText() const { return text(view_.way_text); }
  QString hereLabel() const { return text(view_.here_label); }
  bool located() const { return view_.located && !plan_.empty(); }
  /// In pixels of the floor plan; yaw clockwise, as the screen turns.
  double robotX() const { return plan_.to_pixels(view_.robot.position(), 1.0).x(); }
  double robotY() const { return plan_.to_pixels(view_.robot.position(), 1.0).y(); }
  double robotDegrees() const;
  double pixelsPerMeter() const { return 1.0 / plan_.resolution; }
  int planWidth() const { return plan_.width; }
  int planHeight() const { return plan_.height; }
  ButtonsModel* primary() { return &primary_; }
  ButtonsModel* secondary() { return &secondary_; }
  ButtonsModel* service() { return &service_; }
  QString typed() const { return typed_; }

  Q_INVOKABLE void press(const QString& id);
  Q_INVOKABLE void pressStop();
  Q_INVOKABLE void pressStart();
  /// A key of the keyboard: a letter, or "\b".
  Q_INVOKABLE void key(const QString& letter);

  void show(const View& view);
  void show_building(const FloorPlan& plan);
  void show_places(const std::vector<Place>& places);
  void show_route(const std::vector<geometry::Point2>& route);

  const View& view() const { return view_; }
  const FloorPlan& plan() const { return plan_; }
  const QImage& building() const { return building_; }
  const std::vector<Place>& places() const { return places_; }
  const std::vector<geometry::Point2>& route() const { return route_; }
  /// Whether this is the place that the screen is about.
  bool marks(const Place& place) const { return place.name == view_.place; }

  std::function<void(const std::string&)> on_press;
  std::function<void(const std::string&)> on_typed;

 signals:
  void changed();
  void typedChanged();
  void buildingChanged();
  void mapChanged();  ///< building, places or the marked place
  void routeChanged();

 private:
  static QString text(const std::string& utf8) { return QString::fromStdString(utf8); }

  View view_;
  FloorPlan plan_;
  QImage building_;
  std::vector<Place> places_;
  std::vector<geometry::Point2> route_;
  ButtonsModel primary_, secondary_, service_;
  QString typed_;
};

}  // namespace usher::tablet
