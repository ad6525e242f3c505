import QtQuick
import Usher.Tablet

// The map, as high as the page has room; beside it what is told and what can be done: on a journey
// the way that is left, the text, the buttons.
Item {
    id: page

    required property double u
    required property ScreenModel model
    readonly property bool journey: model.page === ScreenModel.Journey
    readonly property double side: 720 * u
    property bool animate: true
    // The buttons may use the room beside the bar below.
    property double below: 0

    MapView {
        id: map
        anchors.left: parent.left
        anchors.top: parent.top
        anchors.bottom: parent.bottom
        anchors.right: column.left
        anchors.rightMargin: 40 * page.u
        u: page.u
        model: page.model
        animate: page.animate
    }
    Item {
        id: column
        anchors.right: parent.right
        anchors.top: parent.top
        width: page.side
        height: parent.height + page.below

        Column {
            anchors.top: parent.top
            width: parent.width
            spacing: 20 * page.u
            Text {
                objectName: "way"
                width: parent.width
                text: page.model.wayText
                visible: page.journey && text !== ""
                color: Theme.title
                font.pixelSize: Theme.buttonTextSize * page.u
                fontSizeMode: Text.HorizontalFit
                minimumPixelSize: Theme.statusSize * page.u
                font.weight: Font.DemiBold
                horizontalAlignment: Text.AlignHCenter
            }
            Rectangle {
                width: parent.width
                height: 28 * page.u
                radius: height / 2
                color: Theme.surface
                visible: page.journey && page.model.progress >= 0
                Rectangle {
                    width: Math.max(parent.height, parent.width * Math.min(1, page.model.progress))
                    height: parent.height
                    radius: height / 2
                    color: Theme.yes
                }
            }
            Text {
                objectName: "body"
                width: parent.width
                text: page.model.text
                visible: text !== ""
                color: Theme.text
                font.pixelSize: Theme.statusSize * page.u
                horizontalAlignment: Text.AlignHCenter
                wrapMode: Text.WordWrap
                Accessible.role: Accessible.StaticText
                Accessible.name: text
            }
        }
        Column {
            anchors.bottom: parent.bottom
            width: parent.width
            spacing: 24 * page.u
            ButtonRow {
                u: page.u
                buttons: page.model.primary
                visible: buttons.count > 0
                stacked: true
                fill: page.side
                buttonHeight: 200 * page.u
                textSize: 100 * page.u
                onPressed: buttonId => page.model.press(buttonId)
            }
            ButtonRow {
                u: page.u
                buttons: page.model.secondary
                stacked: true
                fill: page.side
                onPressed: buttonId => page.model.press(buttonId)
            }
        }
    }
}
